// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/spectrum.hpp"

#include <Eigen/Core>
#include <unsupported/Eigen/FFT>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace aeolis::telemetry {

int smooth_length(int least) {
    for (int n = std::max(least, 8);; ++n) {
        int rest = n;
        for (const int factor : {2, 3, 5})
            while (rest % factor == 0) rest /= factor;
        if (rest == 1) return n;
    }
}

double peak_offset(double before, double at, double after) {
    const double bend = before - 2.0 * at + after;
    return bend < 0.0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0.0;
}

struct Spectrum::State {
    std::vector<float> window, powers;
    std::vector<std::complex<float>> weighed, transformed;
    Eigen::FFT<float> fft;
};

Spectrum::Spectrum(int samples) : state_(std::make_unique<State>()) {
    const auto length = static_cast<std::size_t>(smooth_length(samples));
    for (int i = 0; i < samples; ++i)
        state_->window.push_back(
            static_cast<float>(0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * (i + 0.5) / samples)));
    state_->weighed.resize(length);
    state_->transformed.resize(length);
    state_->powers.resize(length);
}
Spectrum::~Spectrum() = default;
Spectrum::Spectrum(const Spectrum& other) : state_(std::make_unique<State>(*other.state_)) {}
Spectrum::Spectrum(Spectrum&&) noexcept = default;
Spectrum& Spectrum::operator=(Spectrum&&) noexcept = default;

const std::vector<float>& Spectrum::powers(std::span<const std::complex<float>> samples) {
    State& s = *state_;
    float weight = 0.0F;
    for (std::size_t i = 0; i < s.window.size() && i < samples.size(); ++i) {
        s.weighed[i] = s.window[i] * samples[i];
        if (samples[i] != std::complex<float>{}) weight += s.window[i] * s.window[i];
    }
    s.fft.fwd(s.transformed, s.weighed);
    for (std::size_t i = 0; i < s.powers.size(); ++i)
        s.powers[i] = weight > 0.0F ? std::norm(s.transformed[i]) / weight : 0.0F;
    return s.powers;
}

}  // namespace aeolis::telemetry
