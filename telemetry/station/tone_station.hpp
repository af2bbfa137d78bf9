// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mfsk_waveform.hpp"
#include "common/time_table.hpp"
#include "telemetry/mfsk/doppler_remover.hpp"
#include "telemetry/mfsk/thinned_spectrum.hpp"
#include "telemetry/mfsk/tone_receiver.hpp"
#include "telemetry/port.hpp"
#include "telemetry/station/received.hpp"

#include <complex>
#include <optional>
#include <vector>

namespace aeolis::telemetry {

/// The receiving half of a deep-space station: tones and the state of X-band from samples.
///
/// In       X-band samples in order, without a gap
/// Out      decisions, the carrier, whether there is one, spectra
/// Rate     16384 samples a second, or that of a recording; 2 ms of processor time a second of signal
/// Rule     X-band is up while a carrier is tracked. Before the first one it is down once the receiver has searched for
///          `first_search_s` without success; an unnoticed carrier leaves no report
/// Memory   the receiver's, and a second of samples
/// A value, like the station that holds it.
class ToneStation {
  public:
    static constexpr double first_search_s = 10.0;  ///< chosen: twice the longest search

    /// Properties of samples that were recorded elsewhere.
    struct Samples {
        double rate_hz = x_band_rate_hz;  ///< as ToneReceiver takes it
        TimeTable expected_hz{};          ///< Doppler still in them, beyond the predict
        std::vector<double> excluded_hz{};
    };

    /// `predict_hz`: the predict removed, by seconds from `entry`. `entry`: arrival of a signal sent at the predicted
    /// entry.
    ToneStation(const MfskWaveform& waveform, TimeTable predict_hz, Ert entry)
        : ToneStation(waveform, std::move(predict_hz), entry, Samples{}) {}
    ToneStation(const MfskWaveform& waveform, TimeTable predict_hz, Ert entry, Samples recorded)
        : waveform_(waveform), predict_hz_(std::move(predict_hz)), entry_(entry), recorded_(std::move(recorded)) {}

    /// Appends decisions to `out`, up to 20 s after a symbol's end.
    void receive(const Downlink& downlink, Received& out);

    const ReceiverStatus& status() const { return receiver_->status(); }
    bool has_begun() const { return receiver_.has_value(); }

  private:
    void push(Ert now, Received& out);
    void tell_link(bool up, Ert now, Received& out);
    ReceivedTone told(const ToneReception& reception) const;
    ReceivedCarrier told(const CarrierReport& report, Ert now) const;
    Ert ert_of(double from_entry_s) const;

    MfskWaveform waveform_;
    TimeTable predict_hz_;
    Ert entry_;
    Samples recorded_;
    std::optional<ToneReceiver> receiver_;  ///< from the first sample on
    std::optional<ThinnedSpectrum> spectrum_;
    std::optional<DopplerRemover> remover_;  ///< of the Doppler that is still in the samples, for the spectrum
    std::vector<std::complex<float>> samples_;
    bool ended_ = false;
    bool follows_ = false;    ///< a carrier, as reported
    std::optional<bool> up_;  ///< as reported; none: not yet
};

}  // namespace aeolis::telemetry
