// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/time_table.hpp"
#include "telemetry/mfsk/carrier_search.hpp"
#include "telemetry/mfsk/symbol_sequence.hpp"

#include <complex>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace aeolis::telemetry {

/// A decided tone or an erasure, with its evidence.
struct ToneReception {
    std::optional<std::uint8_t> tone;           ///< none: erased
    double start_s = 0.0;                       ///< in the samples' time, to a hop (1/8 s)
    double total_c_n0_dbhz = 0.0;               ///< total power to noise density
    double doppler_hz = 0.0;                    ///< predicted plus tracked; the symbol's mean
    CarrierLock lock = CarrierLock::searching;  ///< the worst during the symbol
    double seen_fraction = 0.0;                 ///< fraction of the symbol with a carrier
    ToneEvidence evidence;
};

/// The receiver's state after the newest decided hop.
struct ReceiverStatus {
    CarrierLock lock = CarrierLock::searching;
    double total_c_n0_dbhz = 0.0, doppler_hz = 0.0;
    double carrier_s = 0.0, without_s = 0.0;  ///< present times with and without a carrier
    int acquisitions = 0;
    double loudest = 0.0;  ///< largest power of a sample
};

/// Ground's receiver of X-band tones: complex samples in, decisions out.
///
/// In      blocks of samples of any length, at a fixed rate; the predict that was removed before sampling
/// Out     one reception a symbol by take(), 1 to 20 s after the symbol's end
/// Memory  4 s of samples in search, 5 s in tracking, the sums of a few symbols
/// Faults  silence, noise and values that are not numbers give no reception; a pulse far above the rest is blanked; a
///         lost carrier is searched for again
class ToneReceiver {
  public:
    static constexpr double rate_least_hz = 3000.0, rate_greatest_hz = 1.0e6;  ///< chosen

    /// Fails for a rate out of range or too low for the tones. `start_s`: the first sample's time on the scale of
    /// `predict_hz`.
    static Result<ToneReceiver> make(const MfskWaveform& waveform, double rate_hz, TimeTable predict_hz = {},
                                     double start_s = 0.0);

    void push(std::span<const std::complex<float>> samples);
    /// Decides everything that still waits, as if no more samples came.
    void finish();
    /// Receptions since the last call, in the order of time.
    std::vector<ToneReception> take();

    const ReceiverStatus& status() const { return status_; }

  private:
    ToneReceiver(const MfskWaveform& waveform, double rate_hz, TimeTable predict_hz, double start_s);

    bool is_pulse(const std::complex<float>& sample);
    std::span<const std::complex<float>> kept() const { return std::span{samples_}.subspan(head_); }
    void drop(std::size_t count);
    void work();
    bool search();
    bool track();
    void pass_without_carrier();  ///< drops the first kept hop
    void weigh_hops();
    void publish();

    MfskWaveform waveform_;
    HopLayout layout_;
    TimeTable predict_hz_;
    double start_s_;
    CarrierSearch carrier_search_;
    CarrierTracker tracker_;
    ToneCorrelator correlator_;
    SymbolSequence sequence_;

    std::vector<std::complex<float>> samples_;  ///< from head_: not yet tracked
    std::size_t head_ = 0;
    std::int64_t first_kept_ = 0;                   ///< number of the sample at head_
    std::int64_t search_began_ = 0, searched_ = 0;  ///< numbers of samples
    bool tracking_ = false;

    std::vector<CarrierHop> hops_;
    std::vector<DecidedSymbol> decided_;
    std::vector<ToneReception> receptions_;
    double mean_power_ = 0.0;  ///< recent mean of the samples; 0: none yet
    double lead_s_ = 0.0;      ///< of the subcarriers' time, by Doppler
    double carrier_n0_hz_ = 0.0;
    ReceiverStatus status_;
};

}  // namespace aeolis::telemetry
