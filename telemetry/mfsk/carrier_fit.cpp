// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/carrier_fit.hpp"

#include "telemetry/mfsk/spectrum.hpp"

#include <Eigen/Core>
#include <unsupported/Eigen/FFT>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace aeolis::telemetry {
namespace {

constexpr double line_step = 1.6;  // rates 1.6/T² apart: at most 0.2 dB between two lines before refinement; chosen

}  // namespace

struct CarrierFit::State {
    State(int samples, double step)
        : length(samples), step_s(step), bins(smooth_length(2 * samples)), bin_hz(1.0 / (bins * step)),
          rate_step_hzps(line_step / (samples * step * samples * step)), chirps(length, 2 * rate_lines_max + 1),
          dechirped(static_cast<std::size_t>(bins)), transformed(static_cast<std::size_t>(bins)) {
        for (int l = -rate_lines_max; l <= rate_lines_max; ++l)
            for (int i = 0; i < length; ++i) {
                const double t = time_s(i);
                chirps(i, l + rate_lines_max) =
                    static_cast<std::complex<float>>(std::polar(1.0, -std::numbers::pi * l * rate_step_hzps * t * t));
            }
    }

    double time_s(int i) const { return (i - 0.5 * (length - 1)) * step_s; }
    std::size_t wrapped(int bin) const { return static_cast<std::size_t>((bin % bins + bins) % bins); }

    void transform(std::span<const std::complex<float>> samples, int rate_line) {
        for (int i = 0; i < length; ++i)
            dechirped[static_cast<std::size_t>(i)] =
                samples[static_cast<std::size_t>(i)] * chirps(i, rate_line + rate_lines_max);
        fft.fwd(transformed, dechirped);
    }

    /// Σ x exp(−j 2π (f t + q t²/2)) over the window.
    std::complex<double> sum(std::span<const std::complex<float>> samples, double frequency_hz,
                             double rate_hzps) const {
        const double begin_s = time_s(0);
        const double turn = 2.0 * std::numbers::pi;
        std::complex<double> phasor =
            std::polar(1.0, -turn * (frequency_hz * begin_s + 0.5 * rate_hzps * begin_s * begin_s));
        std::complex<double> step =
            std::polar(1.0, -turn * (frequency_hz * step_s + rate_hzps * step_s * (begin_s + 0.5 * step_s)));
        const std::complex<double> bend = std::polar(1.0, -turn * rate_hzps * step_s * step_s);
        std::complex<double> total{};
        for (const auto& sample : samples) {
            total += static_cast<std::complex<double>>(sample) * phasor;
            phasor *= step;
            step *= bend;
        }
        return total;
    }

    int length;
    double step_s;
    int bins;
    double bin_hz, rate_step_hzps;
    Eigen::ArrayXXcf chirps;
    std::vector<std::complex<float>> dechirped, transformed;
    Eigen::FFT<float> fft;
};

CarrierFit::CarrierFit(int length, double step_s) : state_(std::make_unique<State>(length, step_s)) {}
CarrierFit::~CarrierFit() = default;
CarrierFit::CarrierFit(const CarrierFit& other) : state_(std::make_unique<State>(*other.state_)) {}
CarrierFit::CarrierFit(CarrierFit&&) noexcept = default;
CarrierFit& CarrierFit::operator=(CarrierFit&&) noexcept = default;

double CarrierFit::rate_step_hzps() const {
    return state_->rate_step_hzps;
}

CarrierLine CarrierFit::fit(std::span<const std::complex<float>> samples, double noise, const FitSpan& span) {
    State& s = *state_;
    const int bins_aside = std::min(static_cast<int>(span.frequency_hz / s.bin_hz), s.bins / 2 - 1);
    float most = -1.0F;
    int best_line = 0, best_bin = 0;
    double bin_offset = 0.0;
    std::vector<double> peaks(
        static_cast<std::size_t>(2 * span.rate_lines + 1));  // magnitude of each line's highest bin
    for (int line = -span.rate_lines; line <= span.rate_lines; ++line) {
        s.transform(samples, line);
        float highest = -1.0F;
        int highest_bin = 0;
        for (int bin = -bins_aside; bin <= bins_aside; ++bin) {
            const float power = std::norm(s.transformed[s.wrapped(bin)]);
            if (power > highest) {
                highest = power;
                highest_bin = bin;
            }
        }
        peaks[static_cast<std::size_t>(line + span.rate_lines)] = std::sqrt(highest);
        if (highest > most) {
            most = highest;
            best_line = line;
            best_bin = highest_bin;
            const auto magnitude = [&](int bin) {
                return static_cast<double>(std::abs(s.transformed[s.wrapped(bin)]));
            };
            bin_offset = peak_offset(magnitude(best_bin - 1), magnitude(best_bin), magnitude(best_bin + 1));
        }
    }
    const auto peak = static_cast<std::size_t>(best_line + span.rate_lines);
    const bool inside = peak > 0 && peak + 1 < peaks.size();
    const double line_offset = inside ? peak_offset(peaks[peak - 1], peaks[peak], peaks[peak + 1]) : 0.0;

    CarrierLine found;
    found.frequency_hz = (best_bin + bin_offset) * s.bin_hz;
    found.rate_hzps = (best_line + line_offset) * s.rate_step_hzps;
    const std::complex<double> total = s.sum(samples, found.frequency_hz, found.rate_hzps);
    found.phase_rad = std::arg(total);
    found.amplitude = std::abs(total) / s.length;
    found.energy = std::norm(total) / (s.length * noise);
    return found;
}

}  // namespace aeolis::telemetry
