// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/tone_correlator.hpp"

#include <Eigen/Core>

#include <cmath>
#include <numbers>

namespace aeolis::telemetry {

struct ToneCorrelator::State {
    MfskWaveform waveform;
    Eigen::MatrixXf tones;          // cosines of all, then negative sines
    mutable Eigen::VectorXf parts;  // of the sums, in the same order
};

ToneCorrelator::ToneCorrelator(const MfskWaveform& waveform, double sample_rate_hz, int samples)
    : state_(new State{waveform, Eigen::MatrixXf(2 * MfskWaveform::tones, samples),
                       Eigen::VectorXf(2 * MfskWaveform::tones)}) {
    for (int tone = 0; tone < MfskWaveform::tones; ++tone)
        for (int i = 0; i < samples; ++i) {
            const double angle = 2.0 * std::numbers::pi * waveform.tone_hz(tone) * (i + 0.5) / sample_rate_hz;
            state_->tones(tone, i) = static_cast<float>(std::cos(angle));
            state_->tones(MfskWaveform::tones + tone, i) = static_cast<float>(-std::sin(angle));
        }
}
ToneCorrelator::~ToneCorrelator() = default;
ToneCorrelator::ToneCorrelator(const ToneCorrelator& other) : state_(std::make_unique<State>(*other.state_)) {}
ToneCorrelator::ToneCorrelator(ToneCorrelator&&) noexcept = default;

void ToneCorrelator::correlate(std::span<const float> quadrature, double begin_s, ToneSums& sums) const {
    const Eigen::Map<const Eigen::VectorXf> samples{quadrature.data(), static_cast<Eigen::Index>(quadrature.size())};
    state_->parts.noalias() = state_->tones * samples;
    for (int tone = 0; tone < MfskWaveform::tones; ++tone) {
        const double cycles = state_->waveform.tone_hz(tone) * begin_s;
        const auto turn =
            static_cast<std::complex<float>>(std::polar(1.0, -2.0 * std::numbers::pi * (cycles - std::floor(cycles))));
        sums[static_cast<std::size_t>(tone)] =
            turn * std::complex<float>{state_->parts[tone], state_->parts[MfskWaveform::tones + tone]};
    }
}

}  // namespace aeolis::telemetry
