// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mfsk_waveform.hpp"
#include "common/time_table.hpp"
#include "telemetry/mfsk/tone_receiver.hpp"
#include "telemetry/port.hpp"
#include "telemetry/station/received.hpp"

#include <complex>
#include <optional>
#include <vector>

namespace aeolis::telemetry {

/// The receiving half of a deep-space station: tones and the state of X-band out of samples.
///
/// In       X-band samples in order, without a gap           Out   decisions, and whether there is a carrier
/// Rate     16384 samples a second; 2 ms of processor a second of signal
/// Rule     X-band is up while a carrier is followed. Before the first one it is down once the receiver has searched
///          for `first_search_s` in vain; what it never noticed leaves nothing at all
/// Memory   the receiver's, and a second of samples
/// A value, as the station is that it is part of.
class ToneStation {
  public:
    static constexpr double first_search_s = 10.0;  ///< chosen: twice the longest search

    /// `predict_hz`: what was removed, by seconds from `entry`, which is when what leaves at the predicted entry is
    /// heard.
    ToneStation(const MfskWaveform& waveform, TimeTable predict_hz, Ert entry)
        : waveform_(waveform), predict_hz_(std::move(predict_hz)), entry_(entry) {}

    /// What was decided is added to `out`: late, by up to 20 s after a symbol's end.
    void receive(const Downlink& downlink, Received& out);

    const ReceiverStatus& status() const { return receiver_->status(); }

  private:
    void push(Received& out);
    void tell_link(bool up, Ert now, Received& out);
    ReceivedTone told(const ToneReception& reception) const;

    MfskWaveform waveform_;
    TimeTable predict_hz_;
    Ert entry_;
    std::optional<ToneReceiver> receiver_;  ///< from the first sample on
    std::vector<std::complex<float>> samples_;
    bool ended_ = false;
    std::optional<bool> up_;  ///< as it was told; none: not yet
};

}  // namespace aeolis::telemetry
