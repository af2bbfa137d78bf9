// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/fast_normal.hpp"
#include "telemetry/mfsk/tone_correlator.hpp"
#include "tests/support/tone_signal.hpp"

#include <cmath>

namespace telemetry_tone_correlator_test {

using namespace aeolis;
using namespace aeolis::telemetry;
using aeolis::tests::mfsk;

TEST_CASE("hops of one tone add up in phase, those of its neighbours to nothing", "[tones]") {
    constexpr double rate_hz = 4096.0;
    constexpr int samples = 512;
    const ToneCorrelator correlator{mfsk, rate_hz, samples};
    ToneSums total{}, sums{};
    for (int hop = 0; hop < 80; ++hop) {
        std::vector<float> quadrature;
        for (int i = 0; i < samples; ++i) {
            const double t = (hop * samples + i + 0.5) / rate_hz;
            quadrature.push_back(static_cast<float>(std::sin(2.0 * std::numbers::pi * mfsk.tone_hz(17) * t + 0.7)));
        }
        correlator.correlate(quadrature, hop * samples / rate_hz, sums);
        for (std::size_t tone = 0; tone < total.size(); ++tone) total[tone] += sums[tone];
    }
    CHECK(std::abs(total[17]) == Approx(0.5 * 80 * samples).epsilon(1e-3));
    CHECK(std::abs(total[16]) < 0.01 * std::abs(total[17]));
    CHECK(std::abs(total[18]) < 0.01 * std::abs(total[17]));
}

TEST_CASE("noise of deviation 1 gives each tone as much energy as there are samples", "[tones]") {
    simulation::FastNormal noise{3, 0, simulation::Stream::x_band_noise};
    const ToneCorrelator correlator{mfsk, 4096.0, 512};
    double energy = 0.0;
    for (int hop = 0; hop < 100; ++hop) {
        std::vector<float> quadrature(512);
        for (float& sample : quadrature) sample = noise();
        ToneSums sums{};
        correlator.correlate(quadrature, 0.1 * hop, sums);
        for (const auto& sum : sums) energy += std::norm(sum) / 256.0 / 100.0;
    }
    CHECK(energy == Approx(512.0).epsilon(0.03));
}

}  // namespace telemetry_tone_correlator_test
