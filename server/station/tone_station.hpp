// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time_table.hpp"
#include "simulation/landing.hpp"
#include "simulation/links/x_band_sampler.hpp"
#include "telemetry/mfsk/tone_receiver.hpp"

#include <complex>
#include <deque>
#include <optional>
#include <vector>

namespace aeolis::server {

/// The deep-space station that hears the tones: an antenna that samples what arrives, with the predict removed, and the
/// receiver that decodes the samples. The receiver knows nothing of what was sent; that is added for the score
/// afterwards.
///
/// In       X-band fields of each cycle; the symbols that were sent, once they have ended       Out   a decision a
/// symbol Rate     16384 samples a second; 2 to 3 ms of processor a second of signal Memory   the receiver's, a second
/// of samples, symbols that are not decided yet
class ToneStation {
  public:
    /// `predict_hz` by seconds from the scenario's entry.
    ToneStation(const MfskWaveform& waveform, const simulation::Radio& radio, TimeTable predict_hz, std::uint64_t seed,
                std::uint64_t case_number);

    /// What was decided in a cycle is appended to `tones`: late, by up to 20 s after the symbol's end.
    void receive(const simulation::CycleReport& landed, std::vector<simulation::ReceivedTone>& tones);

    const telemetry::ReceiverStatus& status() const { return receiver_->status(); }

  private:
    void sample(const simulation::XBandField& field);
    void decide(double now_e_s, std::vector<simulation::ReceivedTone>& tones);
    simulation::ReceivedTone told(const telemetry::ToneReception& reception) const;

    MfskWaveform waveform_;
    double total_c_n0_dbhz_;
    TimeTable predict_hz_;
    simulation::XBandSampler sampler_;
    std::optional<telemetry::ToneReceiver> receiver_;  ///< from the first field on
    std::vector<std::complex<float>> samples_;
    double last_e_s_ = 0.0, last_doppler_hz_ = 0.0;
    bool ended_ = false;
    std::int64_t entry_ert_us_ = 0;  ///< when what left at the scenario's entry arrives
    std::deque<simulation::ReceivedTone> undecided_;
};

}  // namespace aeolis::server
