// SPDX-License-Identifier: Apache-2.0
#include "simulation/random.hpp"
#include "telemetry/mfsk/symbol_error.hpp"
#include "telemetry/mfsk/tone_evidence.hpp"
#include "tests/support/catch.hpp"

#include <cmath>
#include <numbers>

namespace telemetry_tone_evidence_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

/// Sums as a symbol of E/N0 = energy would give them; `sent` below 0: noise alone.
ToneSums drawn(int sent, double energy, simulation::Random& random) {
    ToneSums sums{};
    const double deviation = std::sqrt(0.5 * energy);
    for (auto& sum : sums)
        sum = {static_cast<float>(deviation * random.normal()), static_cast<float>(deviation * random.normal())};
    if (sent >= 0)
        sums[static_cast<std::size_t>(sent)] += std::complex<float>{std::polar(energy, 6.28 * random.uniform())};
    return sums;
}

ToneEvidence weighed(const ToneSums& sums, double energy, simulation::Random& random) {
    return tone_evidence_of(sums, drawn(-1, energy, random), equal_sidebands(), energy);
}

}  // namespace

TEST_CASE("the likeliest tone is wrong as often as exact theory says", "[tones][R31]") {
    simulation::Random random{11, 0, simulation::Stream::x_band};
    for (const double theory : {0.1, 0.03}) {
        const double energy = energy_for_symbol_error(theory, 256);
        constexpr int trials = 4000;
        int wrong = 0;
        for (int i = 0; i < trials; ++i)
            wrong += weighed(drawn(i % 256, energy, random), energy, random).best[0].tone != i % 256;
        const double deviation = std::sqrt(theory * (1.0 - theory) / trials);
        CHECK(wrong / static_cast<double>(trials) == Approx(theory).margin(3.5 * deviation));
    }
}

TEST_CASE("the likelihood given is the share of decisions that are right", "[tones]") {
    simulation::Random random{12, 0, simulation::Stream::x_band};
    double promised = 0.0;
    int right = 0;
    for (int i = 0; i < 4000; ++i) {
        const ToneEvidence evidence = weighed(drawn(5, 12.0, random), 12.0, random);
        promised += evidence.best[0].likelihood;
        right += evidence.best[0].tone == 5;
        CHECK(evidence.best[0].likelihood >= evidence.best[4].likelihood);
    }
    CHECK(promised == Approx(right).epsilon(0.03));
}

TEST_CASE("a symbol is likelier than none when it is there, and less likely when it is not", "[tones]") {
    simulation::Random random{13, 0, simulation::Stream::x_band};
    for (int i = 0; i < 200; ++i) {
        CHECK(weighed(drawn(200, 60.0, random), 60.0, random).log_likelihood_ratio > 10.0);
        CHECK(weighed(drawn(-1, 60.0, random), 60.0, random).log_likelihood_ratio < 0.0);
    }
    const ToneEvidence strong = weighed(drawn(200, 300.0, random), 300.0, random);
    CHECK(std::ranges::max_element(strong.spectrum) - strong.spectrum.begin() == 100);
    CHECK(spectrum_db(strong.spectrum[100]) == Approx(10.0 * std::log10(300.0)).margin(1.5));  // energy over noise
    CHECK(tone_evidence_of(ToneSums{}, ToneSums{}, equal_sidebands(), 0.0).log_likelihood_ratio ==
          Approx(0.0).margin(1e-9));
}

TEST_CASE("a line in the samples, at one sideband alone, is no tone however strong it is", "[tones]") {
    simulation::Random random{14, 0, simulation::Stream::x_band};
    for (const double energy : {40.0, 100.0, 400.0})
        for (const double strength : {0.3, 0.5, 0.75, 1.0, 3.0, 30.0}) {
            ToneSums sums = drawn(-1, energy, random), in_phase = drawn(-1, energy, random);
            const std::complex<float> line{std::polar(strength * energy, 1.0)};
            sums[77] += line;
            in_phase[77] += std::complex<float>{0.0F, 1.0F} * line;
            INFO(energy << " " << strength);
            CHECK(tone_evidence_of(sums, in_phase, equal_sidebands(), energy).log_likelihood_ratio < 0.0);
        }
}

}  // namespace telemetry_tone_evidence_test
