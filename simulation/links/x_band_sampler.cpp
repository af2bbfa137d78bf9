// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/x_band_sampler.hpp"

#include <cmath>
#include <numbers>

namespace aeolis::simulation {

XBandSampler::XBandSampler(const MfskWaveform& waveform, double rate_hz, std::uint64_t seed, std::uint64_t case_number)
    : waveform_(waveform), rate_hz_(rate_hz), noise_(seed, case_number, Stream::x_band_noise) {}

void XBandSampler::begin(const Stretch& stretch) {
    const double turn_rad = 2.0 * std::numbers::pi / rate_hz_;
    const double bend_rad = turn_rad * (stretch.residual_to_hz - stretch.residual_from_hz) / stretch.samples;
    turn_ = std::polar(1.0, turn_rad * stretch.residual_from_hz + 0.5 * bend_rad);
    turn_of_turn_ = std::polar(1.0, bend_rad);
    carrier_ /= std::abs(carrier_);
    lead_rate_ = stretch.doppler_hz / waveform_.carrier_hz;
    amplitude_ = stretch.total_c_n0_dbhz
                     ? static_cast<float>(std::sqrt(std::pow(10.0, 0.1 * *stretch.total_c_n0_dbhz) / rate_hz_))
                     : 0.0F;
}

void XBandSampler::take(std::span<std::complex<float>> samples, std::optional<std::uint8_t> tone, double tone_age_s) {
    constexpr float deviation = std::numbers::sqrt2_v<float> / 2.0F;  // of each of two components: power 1
    const double sample_s = 1.0 / rate_hz_;
    if (tone && modulated_for_ != tone) {
        modulated_.emplace(waveform_, *tone, rate_hz_);
        modulated_for_ = tone;
    }
    const double tone_hz = tone ? waveform_.tone_hz(*tone) : 0.0;
    double number = 0.0;
    for (auto& sample : samples) {
        std::complex<float> value{amplitude_, 0.0F};
        if (tone) value = amplitude_ * modulated_->at(tone_hz * (tone_age_s + number * sample_s + lead_s_));
        const auto carrier = static_cast<std::complex<float>>(carrier_);
        const float in_phase = value.real() * carrier.real() - value.imag() * carrier.imag();
        const float quadrature = value.real() * carrier.imag() + value.imag() * carrier.real();
        const float noise_in_phase = noise_(), noise_quadrature = noise_();
        sample = {in_phase + deviation * noise_in_phase, quadrature + deviation * noise_quadrature};
        carrier_ = {carrier_.real() * turn_.real() - carrier_.imag() * turn_.imag(),
                    carrier_.real() * turn_.imag() + carrier_.imag() * turn_.real()};
        turn_ = {turn_.real() * turn_of_turn_.real() - turn_.imag() * turn_of_turn_.imag(),
                 turn_.real() * turn_of_turn_.imag() + turn_.imag() * turn_of_turn_.real()};
        lead_s_ += lead_rate_ * sample_s;
        number += 1.0;
    }
}

}  // namespace aeolis::simulation
