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

/// A tone, or an erasure, and why.
struct ToneReception {
    std::optional<std::uint8_t> tone;           ///< none: erased
    double start_s = 0.0;                       ///< in the samples' time, to a hop (1/8 s)
    double total_c_n0_dbhz = 0.0;               ///< total power to noise density
    double doppler_hz = 0.0;                    ///< predict and what was tracked beyond it; the symbol's mean
    CarrierLock lock = CarrierLock::searching;  ///< the worst during the symbol
    double seen_fraction = 0.0;                 ///< of the symbol, with a carrier
    ToneEvidence evidence;
};

/// What the receiver is at, after the newest decided hop.
struct ReceiverStatus {
    CarrierLock lock = CarrierLock::searching;
    double total_c_n0_dbhz = 0.0, doppler_hz = 0.0;
    double carrier_s = 0.0, without_s = 0.0;  ///< so long with and without a carrier until now
    int acquisitions = 0;
    double loudest = 0.0;  ///< greatest power of a sample
};

/// The ground's receiver of X-band tones: complex samples in, decisions out.
///
/// In      blocks of samples of any length, at a fixed rate; the predict that was removed before sampling
/// Out     a reception a symbol, 1 to 20 s after the symbol's end, by take()
/// Memory  4 s of samples while it searches, 5 s while it tracks, a few symbols of sums
/// Faults  silence, noise and what is no number give no reception; a pulse far above the rest is blanked; a carrier
///         lost is searched for again
class ToneReceiver {
  public:
    static constexpr double rate_least_hz = 3000.0, rate_greatest_hz = 1.0e6;  ///< ours

    /// Fails for a rate that is out of range or cannot hold the tones. `start_s`: the first sample's time in
    /// `predict_hz`.
    static Result<ToneReceiver> make(const MfskWaveform& waveform, double rate_hz, TimeTable predict_hz = {},
                                     double start_s = 0.0);

    void push(std::span<const std::complex<float>> samples);
    /// Nothing more comes: what waits is decided.
    void finish();
    /// What was decided since the last call, in the order of time.
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
    void pass_without_carrier();  ///< the first hop kept
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
    double mean_power_ = 0.0;  ///< of the samples lately; 0: none yet
    double lead_s_ = 0.0;      ///< of the subcarriers' time, by Doppler
    double carrier_n0_hz_ = 0.0;
    ReceiverStatus status_;
};

}  // namespace aeolis::telemetry
