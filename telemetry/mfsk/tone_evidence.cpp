// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/tone_evidence.hpp"

#include "common/bessel.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::telemetry {

ToneEvidence weigh(const ToneSums& sums, double energy) {
    std::array<double, MfskWaveform::tones> log_ratio{};
    ToneEvidence evidence;
    for (std::size_t tone = 0; tone < sums.size(); ++tone) {
        const double magnitude = std::abs(sums[tone]);
        log_ratio[tone] = log_bessel_i0(2.0 * magnitude) - energy;
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
