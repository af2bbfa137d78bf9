// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/tone_detection.hpp"

#include "common/bessel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>

namespace aeolis::simulation {

ToneDecision detect_tone(int sent, double tone_c_n0_dbhz, double symbol_s, Random& random) {
    const double energy = std::pow(10.0, 0.1 * tone_c_n0_dbhz) * symbol_s;  // E/N0
    const double amplitude = std::sqrt(2.0 * energy);
    std::array<double, 256> envelope{};
    for (int tone = 0; tone < 256; ++tone) {
        const double in_phase = random.normal() + (tone == sent ? amplitude : 0.0);
        const double quadrature = random.normal();
        envelope[static_cast<std::size_t>(tone)] = std::hypot(in_phase, quadrature);
    }
    ToneDecision decision;
    std::array<std::uint8_t, 256> order{};
    std::iota(order.begin(), order.end(), std::uint8_t{0});
    std::ranges::partial_sort(order, order.begin() + decision.best.size(), std::greater{},
                              [&](std::uint8_t tone) { return envelope[tone]; });
    const auto log_likelihood = [&](std::size_t tone) { return log_bessel_i0(amplitude * envelope[tone]); };
    const double largest = log_likelihood(order[0]);
    double sum = 0.0;
    for (std::size_t tone = 0; tone < envelope.size(); ++tone) sum += std::exp(log_likelihood(tone) - largest);
    for (std::size_t i = 0; i < decision.best.size(); ++i)
        decision.best[i] = {order[i], std::exp(log_likelihood(order[i]) - largest) / sum};
    const double most = envelope[order[0]];
    const double estimated_energy = std::max(0.5 * most * most - 1.0, 0.1);
    decision.tone_c_n0_dbhz = 10.0 * std::log10(estimated_energy / symbol_s);
    return decision;
}

}  // namespace aeolis::simulation
