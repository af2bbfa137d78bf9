// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/x_band_channel.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::simulation {
namespace {

constexpr double channel_step_s =
    1.0 / 128.0;  // chosen: Doppler bends the phase by 1e-4 cycles within a step, at 1000 Hz/s²

}  // namespace

XBandChannel::XBandChannel(const MfskWaveform& waveform, XBandPath path, std::vector<SentTone> tones,
                           std::uint64_t seed, std::uint64_t case_number)
    : path_(std::move(path)), tones_(std::move(tones)), symbol_s_(waveform.symbol_s),
      sampler_(waveform, path_.rate_hz, seed, case_number),
      step_samples_(std::max(1, static_cast<int>(path_.rate_hz * channel_step_s))),
      step_end_residual_hz_(path_.doppler_hz.at(path_.start_s) - path_.predict_hz.at(path_.start_s)),
      step_end_doppler_hz_(path_.doppler_hz.at(path_.start_s)) {}

void XBandChannel::begin_step() {
    const double end_s = path_.start_s + static_cast<double>(sample_ + step_samples_) / path_.rate_hz;
    XBandSampler::Stretch step;
    step.samples = step_samples_;
    step.residual_from_hz = step_end_residual_hz_;
    step_end_residual_hz_ = path_.doppler_hz.at(end_s) - path_.predict_hz.at(end_s);
    step.residual_to_hz = step_end_residual_hz_;
    const double doppler_from_hz = step_end_doppler_hz_;
    step_end_doppler_hz_ = path_.doppler_hz.at(end_s);
    step.doppler_hz = 0.5 * (doppler_from_hz + step_end_doppler_hz_);
    const bool set = path_.set_s && end_s > *path_.set_s;
    if (!set) step.total_c_n0_dbhz = path_.total_c_n0_dbhz + path_.gain_db.at(end_s);
    sampler_.begin(step);
    step_left_ = step_samples_;
}

int XBandChannel::alike() const {
    if (tone_ == tones_.size()) return step_left_;
    const double start_s = tones_[tone_].start_s, change_s = time_s() < start_s ? start_s : start_s + symbol_s_;
    const double samples = std::ceil((change_s - time_s()) * path_.rate_hz);
    return samples < step_left_ ? std::max(1, static_cast<int>(samples)) : step_left_;
}

void XBandChannel::next(std::span<std::complex<float>> samples) {
    while (!samples.empty()) {
        if (step_left_ == 0) begin_step();
        while (tone_ < tones_.size() && time_s() >= tones_[tone_].start_s + symbol_s_) ++tone_;
        const bool sending = tone_ < tones_.size() && time_s() >= tones_[tone_].start_s;
        const auto now = std::min(samples.size(), static_cast<std::size_t>(alike()));
        if (sending)
            sampler_.take(samples.first(now), tones_[tone_].tone, time_s() - tones_[tone_].start_s);
        else
            sampler_.take(samples.first(now), {}, 0.0);
        samples = samples.subspan(now);
        sample_ += static_cast<std::int64_t>(now);
        step_left_ -= static_cast<int>(now);
    }
}

}  // namespace aeolis::simulation
