// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/tone_evidence.hpp"

#include "common/bessel.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::telemetry {
namespace {

constexpr double line_cost =
    10.0;  // −ln of how seldom a line lies at a given sideband, and of its strength's fit; chosen
constexpr double absent_share = 0.25,
                 absent_cost = 4.0;  // of evidence against a sideband: more, and it is absent; chosen

}  // namespace

ToneEvidence tone_evidence_of(const ToneSums& sums, const ToneSums& in_phase, const SidebandRatios& ratios,
                              double energy) {
    std::array<double, MfskWaveform::tones> log_ratio{};
    ToneEvidence evidence;
    for (std::size_t tone = 0; tone < sums.size(); ++tone) {
        const double magnitude = std::abs(sums[tone]);
        const std::complex<float> turned{-sums[tone].imag(), sums[tone].real()};
        // The mean of both sidebands' noise is 1.
        const float lower = 2.0F / (1.0F + ratios[tone]), upper = lower * ratios[tone];
        const double sideband =
            0.5 * std::max(std::norm(in_phase[tone] + turned) / upper, std::norm(in_phase[tone] - turned) / lower);
        const double ratio = log_bessel_i0(2.0 * magnitude) - energy;
        // Of a tone, a line would explain one sideband: half. What it explains beyond that speaks against the tone.
        const double line = sideband / std::max(energy, 1e-9) - 0.5 * std::max(ratio, 0.0) - line_cost;
        log_ratio[tone] = ratio - std::max(line, 0.0);
        // And of a tone the weaker sideband has half the energy, too.
        const double half = 0.5 * energy;
        const double weaker = 0.5 * std::min(std::norm(in_phase[tone] + turned), std::norm(in_phase[tone] - turned)) /
                              std::max(energy, 1e-9);
        const double other = log_bessel_i0(2.0 * std::sqrt(weaker * half)) - half;
        if (other < -absent_share * half - absent_cost) log_ratio[tone] = std::min(log_ratio[tone], other);
        std::uint8_t& level = evidence.spectrum[tone / 2];
        level =
            std::max(level, spectrum_octet(10.0 * std::log10(magnitude * magnitude / std::max(energy, 1e-9) + 1e-3)));
    }
    std::array<std::uint8_t, MfskWaveform::tones> order{};
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint8_t>(i);
    std::ranges::partial_sort(order, order.begin() + 5, [&](auto a, auto b) { return log_ratio[a] > log_ratio[b]; });
    const double largest = log_ratio[order[0]];
    double sum = 0.0;
    for (const double value : log_ratio) sum += std::exp(value - largest);
    for (std::size_t i = 0; i < evidence.best.size(); ++i)
        evidence.best[i] = {order[i], std::exp(log_ratio[order[i]] - largest) / sum};
    evidence.log_likelihood_ratio = largest + std::log(sum) - std::log(static_cast<double>(sums.size()));
    return evidence;
}

}  // namespace aeolis::telemetry
