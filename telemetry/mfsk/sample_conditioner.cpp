// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/sample_conditioner.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace aeolis::telemetry {
namespace {

constexpr double pulse_ratio = 1e4;          // chosen: 40 dB
constexpr double power_gain = 1.0 / 1024.0;  // of each sample in the running mean of power; chosen
constexpr double run_s = 0.002;              // chosen; and 32 samples, which a coarse converter repeats seldom
constexpr std::int64_t run_least = 32;
constexpr double notch_s = 0.5;  // chosen: the notch is 0.3 Hz wide to either side

/// Power as double, because the square of a float may overflow one.
double power_of(const std::complex<float>& sample) {
    return std::norm(std::complex<double>{sample});
}

/// Median of a block's powers: a few pulses do not move it.
double middle_power(std::span<const std::complex<float>> samples) {
    std::vector<double> powers;
    for (const auto& sample : samples)
        if (const double power = power_of(sample); std::isfinite(power) && power > 0.0) powers.push_back(power);
    if (powers.empty()) return 0.0;
    const auto middle = powers.begin() + static_cast<std::ptrdiff_t>(powers.size() / 2);
    std::ranges::nth_element(powers, middle);
    return *middle;
}

}  // namespace

SampleConditioner::SampleConditioner(double rate_hz, std::span<const double> excluded_hz)
    : rate_hz_(rate_hz), notch_gain_(1.0 / (notch_s * rate_hz)),
      run_longest_(std::max(run_least, static_cast<std::int64_t>(run_s * rate_hz))) {
    for (const double hz : excluded_hz) exclude(hz);
}

void SampleConditioner::exclude(double line_hz) {
    notches_.push_back({std::polar(1.0, -2.0 * std::numbers::pi * line_hz / rate_hz_), {1.0, 0.0}, {}});
}

/// The mean follows a lasting change of level within some hundreds of samples.
bool SampleConditioner::is_pulse(const std::complex<float>& sample) {
    const double power = power_of(sample);
    if (!std::isfinite(power)) return true;
    if (mean_power_ == 0.0) mean_power_ = power;
    const double limit = pulse_ratio * mean_power_;
    mean_power_ += power_gain * (std::min(power, limit) - mean_power_);
    // Noise is that weak once in ten thousand samples; a coarse converter's zeros say nothing.
    if (power > 0.0 && power * pulse_ratio < mean_power_) mean_power_ /= 2.0;
    return power > limit;
}

std::complex<float> SampleConditioner::notched(std::complex<float> sample) {
    for (Notch& notch : notches_) {
        const std::complex<double> s{sample}, p = notch.phasor;
        const std::complex<double> down{s.real() * p.real() - s.imag() * p.imag(),
                                        s.real() * p.imag() + s.imag() * p.real()};
        notch.line += notch_gain_ * (down - notch.line);
        const std::complex<double> l = notch.line;
        sample -= std::complex<float>{static_cast<float>(l.real() * p.real() + l.imag() * p.imag()),
                                      static_cast<float>(l.imag() * p.real() - l.real() * p.imag())};
        notch.phasor = {p.real() * notch.turn.real() - p.imag() * notch.turn.imag(),
                        p.real() * notch.turn.imag() + p.imag() * notch.turn.real()};
    }
    return sample;
}

void SampleConditioner::end_run(std::vector<std::complex<float>>& out) {
    if (run_ == 0) return;
    const bool is_gap = run_ >= run_longest_ || !std::isfinite(power_of(run_value_));
    for (std::int64_t i = 0; i < run_; ++i) {
        std::complex<float> sample;
        if (!is_gap && !is_pulse(run_value_)) {
            sample = notched(run_value_);
            if (sample == std::complex<float>{}) sample = {static_cast<float>(1e-6 * std::sqrt(mean_power_)), 0.0F};
        }
        out.push_back(sample);
    }
    run_ = 0;
}

double SampleConditioner::push(std::span<const std::complex<float>> samples, std::vector<std::complex<float>>& out) {
    const std::size_t before = out.size();
    if (mean_power_ == 0.0) mean_power_ = middle_power(samples);
    for (const auto& sample : samples) {
        // A long gap goes out piece by piece: it is one already.
        if (run_ > 0 && (sample != run_value_ || run_ >= 2 * run_longest_)) {
            const bool goes_on = sample == run_value_;
            if (goes_on) {
                out.insert(out.end(), static_cast<std::size_t>(run_ - run_longest_), {});
                run_ = run_longest_;
            } else {
                end_run(out);
            }
        }
        run_value_ = sample;
        ++run_;
    }
    for (auto& phasor : notches_) phasor.phasor /= std::abs(phasor.phasor);
    double most = 0.0;
    for (std::size_t i = before; i < out.size(); ++i) most = std::max(most, power_of(out[i]));
    return most;
}

void SampleConditioner::finish(std::vector<std::complex<float>>& out) {
    end_run(out);
}

}  // namespace aeolis::telemetry
