// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/fast_normal.hpp"
#include "telemetry/mfsk/carrier_fit.hpp"
#include "tests/support/catch.hpp"

#include <cmath>
#include <numbers>
#include <vector>

namespace telemetry_carrier_fit_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

constexpr int length = 160;
constexpr double step_s = 1.0 / 256.0;

std::vector<std::complex<float>> line(double phase_rad, double frequency_hz, double rate_hzps, double amplitude) {
    std::vector<std::complex<float>> samples;
    for (int i = 0; i < length; ++i) {
        const double t = (i - 0.5 * (length - 1)) * step_s;
        samples.emplace_back(
            std::polar(amplitude, phase_rad + 2.0 * std::numbers::pi * (frequency_hz * t + 0.5 * rate_hzps * t * t)));
    }
    return samples;
}

}  // namespace

TEST_CASE("a fit without noise gives phase, frequency, rate and amplitude back", "[tones]") {
    CarrierFit fit{length, step_s};
    for (const auto& [frequency_hz, rate_hzps] :
         {std::pair{0.0, 0.0}, std::pair{31.3, 12.0}, std::pair{-77.7, -60.0}, std::pair{4.1, 75.0}}) {
        const CarrierLine found =
            fit.fit(line(1.0, frequency_hz, rate_hzps, 0.5), 1.0, {100.0, CarrierFit::rate_lines_max});
        CHECK(found.frequency_hz == Approx(frequency_hz).margin(0.1));
        CHECK(found.rate_hzps == Approx(rate_hzps).margin(0.7));
        CHECK(found.phase_rad == Approx(1.0).margin(0.06));
        CHECK(found.amplitude == Approx(0.5).epsilon(0.01));
        CHECK(found.energy == Approx(0.25 * length).epsilon(0.02));
    }
}

TEST_CASE("in noise alone a fit's energy passes 13 about once in 200 looks", "[tones]") {
    simulation::FastNormal noise{5, 0, simulation::Stream::x_band_noise};
    CarrierFit fit{length, step_s};
    int passed = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        std::vector<std::complex<float>> samples(length);
        for (auto& sample : samples)
            sample = {noise() * std::numbers::sqrt2_v<float> / 2.0F, noise() * std::numbers::sqrt2_v<float> / 2.0F};
        passed += fit.fit(samples, 1.0, {40.0, 4}).energy > 13.0;
    }
    CHECK(passed <= 20);
}

}  // namespace telemetry_carrier_fit_test
