// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/standing_lines.hpp"

#include "telemetry/mfsk/spectrum.hpp"

#include <Eigen/Core>
#include <unsupported/Eigen/FFT>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace aeolis::telemetry {
namespace {

constexpr double thinned_hz = 1024.0;    // chosen
constexpr double look_s = 8.0;           // chosen: shorter than a tone
constexpr double line_energy = 60.0;     // 9 dB-Hz; chosen
constexpr double weaker_line = 0.05;     // of the strongest: weaker ones hide nothing; chosen
constexpr double same_line_hz = 0.15;    // chosen
constexpr int line_bins = 6;             // of a line, to either side; chosen
constexpr double more_deviations = 6.0;  // chosen
constexpr std::size_t lines_max = 8;     // chosen
constexpr double line_turn_rad = 2.0 * std::numbers::pi;

}  // namespace

struct StandingLines::State {
    State(double rate_hz, double middle)
        : middle_hz(middle), thinning(std::max(1, static_cast<int>(std::lround(rate_hz / thinned_hz)))),
          length(smooth_length(static_cast<int>(look_s * rate_hz / thinning))), bin_hz(rate_hz / thinning / length),
          step(std::polar(1.0, -line_turn_rad * middle / rate_hz)), windowed(static_cast<std::size_t>(length)),
          transformed(static_cast<std::size_t>(length)) {}

    void add(const std::complex<float>& sample) {
        const std::complex<double> s{sample}, p = phasor;
        if (std::isfinite(s.real()) && std::isfinite(s.imag()))
            sum += std::complex<double>{s.real() * p.real() - s.imag() * p.imag(),
                                        s.real() * p.imag() + s.imag() * p.real()};
        phasor = {p.real() * step.real() - p.imag() * step.imag(), p.real() * step.imag() + p.imag() * step.real()};
        if (++summed < thinning) return;
        thinned.emplace_back(sum / static_cast<double>(thinning));
        sum = {};
        summed = 0;
        phasor /= std::abs(phasor);
        if (std::ssize(thinned) < length) return;
        look();
        thinned.erase(thinned.begin(), thinned.begin() + length / 2);
    }

    void look() {
        for (int i = 0; i < length; ++i)
            windowed[static_cast<std::size_t>(i)] =
                thinned[static_cast<std::size_t>(i)] *
                static_cast<float>(1.0 - std::cos(line_turn_rad * (i + 0.5) / length));
        fft.fwd(transformed, windowed);
        const int aside = std::min(static_cast<int>(reach_hz / bin_hz), length / 2 - 2);
        powers.clear();
        for (int bin = -aside; bin <= aside; ++bin)
            powers.push_back(std::norm(transformed[static_cast<std::size_t>((bin + length) % length)]));
        sorted = powers;
        const auto middle = sorted.begin() + std::ssize(sorted) / 2;
        std::ranges::nth_element(sorted, middle);
        const double noise = std::max(static_cast<double>(*middle) / std::numbers::ln2, 1e-30);
        find(noise, aside);
        ++looks;
    }

    void find(double noise, int aside) {
        std::vector<StandingLine> found;
        std::vector<bool> own(powers.size());
        double strongest = 0.0;
        while (found.size() < lines_max) {
            std::size_t best = 0;
            double most = 0.0;
            for (std::size_t i = 1; i + 1 < powers.size(); ++i)
                if (!own[i] && powers[i] > most) {
                    most = powers[i];
                    best = i;
                }
            strongest = std::max(strongest, most);
            if (most < line_energy * noise || most < weaker_line * strongest) break;
            const auto at = [&](std::size_t i) { return std::sqrt(static_cast<double>(powers[i])); };
            const bool is_peak = powers[best] >= powers[best - 1] && powers[best] >= powers[best + 1];
            if (is_peak)
                found.push_back({middle_hz + (static_cast<double>(best) - aside +
                                              peak_offset(at(best - 1), at(best), at(best + 1))) *
                                                 bin_hz,
                                 most / noise});
            const std::size_t reach = is_peak ? line_bins : 0;
            for (std::size_t i = best - std::min(best, reach); i <= std::min(best + reach, powers.size() - 1); ++i)
                own[i] = true;
        }
        lines.clear();
        for (const StandingLine& line : found)
            if (std::ranges::any_of(before, [&](const StandingLine& other) {
                    return std::abs(other.frequency_hz - line.frequency_hz) < same_line_hz;
                }))
                lines.push_back(line);
        // What is neither noise nor the lines' own.
        double left = 0.0;
        int count = 0;
        for (std::size_t i = 0; i < powers.size(); ++i) {
            const double hz = middle_hz + (static_cast<double>(i) - aside) * bin_hz;
            if (std::ranges::any_of(lines, [&](const StandingLine& line) {
                    return std::abs(line.frequency_hz - hz) <= line_bins * bin_hz;
                }))
                continue;
            left += std::min(static_cast<double>(powers[i]) / noise, line_energy);
            ++count;
        }
        // Of windowed noise two neighbours count as one.
        more = left > count + more_deviations * std::sqrt(2.0 * count);
        before = std::move(found);
    }

    double middle_hz;
    int thinning, length;
    double bin_hz;
    std::complex<double> phasor{1.0, 0.0}, step, sum{};
    int summed = 0;
    std::vector<std::complex<float>> thinned, windowed, transformed;
    std::vector<float> powers, sorted;
    std::vector<StandingLine> before, lines;
    bool more = false;
    std::int64_t looks = 0;
    Eigen::FFT<float> fft;
};

StandingLines::StandingLines(double rate_hz, double middle_hz) : state_(std::make_unique<State>(rate_hz, middle_hz)) {}
StandingLines::~StandingLines() = default;
StandingLines::StandingLines(const StandingLines& other) : state_(std::make_unique<State>(*other.state_)) {}
StandingLines::StandingLines(StandingLines&&) noexcept = default;
StandingLines& StandingLines::operator=(StandingLines&&) noexcept = default;

void StandingLines::push(std::span<const std::complex<float>> samples) {
    for (const auto& sample : samples) state_->add(sample);
}

double StandingLines::middle_hz() const {
    return state_->middle_hz;
}

const std::vector<StandingLine>& StandingLines::lines() const {
    return state_->lines;
}

bool StandingLines::holds_more() const {
    return state_->more;
}

std::int64_t StandingLines::looks() const {
    return state_->looks;
}

}  // namespace aeolis::telemetry
