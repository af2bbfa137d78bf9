// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/doppler_remover.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace aeolis::telemetry {
namespace {

constexpr double remover_step_s = 1.0 / 64.0;  // chosen: bends the phase by 4e-4 cycles within a step, at 1000 Hz/s²

std::complex<double> times(const std::complex<double>& a, const std::complex<double>& b) {
    return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

}  // namespace

DopplerRemover::DopplerRemover(TimeTable expected_hz, double rate_hz, double start_s)
    : expected_hz_(std::move(expected_hz)), rate_hz_(rate_hz), start_s_(start_s),
      step_samples_(std::max(1, static_cast<int>(rate_hz * remover_step_s))) {}

void DopplerRemover::begin_step() {
    const double begin_s = start_s_ + static_cast<double>(sample_) / rate_hz_, step_s = step_samples_ / rate_hz_;
    const double from_hz = expected_hz_.at(begin_s), to_hz = expected_hz_.at(begin_s + step_s);
    const double turn = -2.0 * std::numbers::pi;
    const double bend = (to_hz - from_hz) / step_s / (rate_hz_ * rate_hz_);  // cycles a sample²
    phasor_ = std::polar(1.0, turn * cycles_);
    turn_ = std::polar(1.0, turn * (from_hz / rate_hz_ + 0.5 * bend));
    bend_ = std::polar(1.0, turn * bend);
    cycles_ = std::fmod(cycles_ + 0.5 * (from_hz + to_hz) * step_s, 1.0);
    left_ = step_samples_;
}

void DopplerRemover::remove(std::span<std::complex<float>> samples) {
    for (auto& sample : samples) {
        if (left_ == 0) begin_step();
        if (sample != std::complex<float>{}) sample = std::complex<float>{times(std::complex<double>{sample}, phasor_)};
        phasor_ = times(phasor_, turn_);
        turn_ = times(turn_, bend_);
        --left_;
        ++sample_;
    }
}

}  // namespace aeolis::telemetry
