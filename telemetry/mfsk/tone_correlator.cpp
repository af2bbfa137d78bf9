// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/tone_correlator.hpp"

#include <Eigen/Core>

#include <cmath>
#include <numbers>

namespace aeolis::telemetry {

struct ToneCorrelator::State {
    MfskWaveform waveform;
    Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> tones;  // cosines of all, then negative sines
};

ToneCorrelator::ToneCorrelator(const MfskWaveform& waveform, double sample_rate_hz, int samples)
    : state_(new State{waveform, {}}) {
    state_->tones.resize(2 * MfskWaveform::tones, samples);
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
    ToneSums unused;
    correlate(quadrature, {}, begin_s, sums, unused);
}

void ToneCorrelator::correlate(std::span<const float> quadrature, std::span<const float> in_phase, double begin_s,
                               ToneSums& sums, ToneSums& in_phase_sums) const {
    using Samples = Eigen::Map<const Eigen::RowVectorXf>;
    const Samples across{quadrature.data(), static_cast<Eigen::Index>(quadrature.size())};
    const Samples along{in_phase.data(), static_cast<Eigen::Index>(in_phase.size())};
    for (int tone = 0; tone < MfskWaveform::tones; ++tone) {
        const double cycles = state_->waveform.tone_hz(tone) * begin_s;
        const auto turn =
            static_cast<std::complex<float>>(std::polar(1.0, -2.0 * std::numbers::pi * (cycles - std::floor(cycles))));
        const auto cosines = state_->tones.row(tone), sines = state_->tones.row(MfskWaveform::tones + tone);
        const auto at = static_cast<std::size_t>(tone);
        sums[at] = turn * std::complex<float>{cosines.dot(across), sines.dot(across)};
        if (!in_phase.empty()) in_phase_sums[at] = turn * std::complex<float>{cosines.dot(along), sines.dot(along)};
    }
}

}  // namespace aeolis::telemetry
