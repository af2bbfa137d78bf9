#include "simulation/links/tone_detection.hpp"

#include "common/bessel.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace aeolis::simulation {

ToneDecision detect_tone(int sent, double tone_c_n0_dbhz, double symbol_s, Random& random) {
    const double energy = std::pow(10.0, 0.1 * tone_c_n0_dbhz) * symbol_s; // E/N0
    const double amplitude = std::sqrt(2.0 * energy);
    std::array<double, 256> log_likelihood{};
    ToneDecision decision;
    double most = -1.0, next = -1.0;
    for (int tone = 0; tone < 256; ++tone) {
        const double in_phase = random.normal() + (tone == sent ? amplitude : 0.0);
        const double quadrature = random.normal();
        const double r = std::hypot(in_phase, quadrature);
        log_likelihood[static_cast<std::size_t>(tone)] = log_bessel_i0(amplitude * r);
        if (r > most) {
            next = most;
            decision.second = decision.best;
            most = r;
            decision.best = static_cast<std::uint8_t>(tone);
        } else if (r > next) {
            next = r;
            decision.second = static_cast<std::uint8_t>(tone);
        }
    }
    const double largest = log_likelihood[decision.best];
    double sum = 0.0;
    for (const double value : log_likelihood)
        sum += std::exp(value - largest);
    decision.best_likelihood = 1.0 / sum;
    decision.second_likelihood = std::exp(log_likelihood[decision.second] - largest) / sum;
    const double estimated_energy = std::max(0.5 * most * most - 1.0, 0.1);
    decision.tone_c_n0_dbhz = 10.0 * std::log10(estimated_energy / symbol_s);
    return decision;
}

} // namespace aeolis::simulation
