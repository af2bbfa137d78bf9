// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/sample_conditioner.hpp"

#include "tests/support/catch.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace telemetry_sample_conditioner_test {

using namespace aeolis::telemetry;

namespace {

constexpr double rate_hz = 8192.0;
using Samples = std::vector<std::complex<float>>;

Samples noise(std::size_t count) {
    std::mt19937 random{3};
    std::normal_distribution<float> normal;
    Samples samples(count);
    for (auto& sample : samples) sample = {normal(random), normal(random)};
    return samples;
}

Samples conditioned(std::span<const std::complex<float>> samples, std::vector<double> excluded_hz = {},
                    std::size_t block = 1000) {
    SampleConditioner conditioner{rate_hz, excluded_hz};
    Samples out;
    for (std::size_t at = 0; at < samples.size(); at += block)
        conditioner.push(samples.subspan(at, std::min(block, samples.size() - at)), out);
    conditioner.finish(out);
    return out;
}

}  // namespace

TEST_CASE("zeros, a stuck value, what is no number and pulses are gaps, and each sample keeps its place", "[tones]") {
    Samples samples = noise(20000);
    const float none = std::numeric_limits<float>::quiet_NaN(), endless = std::numeric_limits<float>::infinity();
    for (std::size_t i = 2000; i < 5000; ++i) samples[i] = {};
    for (std::size_t i = 6000; i < 6040; ++i) samples[i] = {3.0F, 1.0F};
    for (std::size_t i = 7000; i < 7003; ++i) samples[i] = {none, 1.0F};
    samples[8000] = {0.0F, -endless};
    samples[9000] = {1e6F, 0.0F};
    const auto is_gap = [](std::size_t i) {
        return (i >= 2000 && i < 5000) || (i >= 6000 && i < 6040) || (i >= 7000 && i < 7003) || i == 8000 || i == 9000;
    };
    for (const std::size_t block : {7U, 1000U, 20000U}) {
        const Samples out = conditioned(samples, {}, block);
        REQUIRE(out.size() == samples.size());
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < out.size(); ++i)
            wrong += out[i] != (is_gap(i) ? std::complex<float>{} : samples[i]) ? 1 : 0;
        CHECK(wrong == 0);
    }
}

TEST_CASE("a few equal samples of a coarse converter are samples, not gaps", "[tones]") {
    Samples samples = noise(50000);
    for (auto& sample : samples) sample = {std::round(sample.real()), std::round(sample.imag())};
    const Samples out = conditioned(samples);
    std::size_t gaps = 0;
    for (std::size_t i = 0; i < out.size(); ++i) {
        gaps += out[i] == std::complex<float>{} ? 1 : 0;
        if (samples[i] != std::complex<float>{}) CHECK(out[i] == samples[i]);
    }
    CHECK(gaps == 0);
}

TEST_CASE("an excluded line leaves, and what is a few hertz beside it stays", "[tones]") {
    for (const double line_hz : {0.0, -1234.5}) {
        Samples samples(40960);
        for (std::size_t n = 0; n < samples.size(); ++n) {
            const double t = static_cast<double>(n) / rate_hz, turn = 2.0 * std::numbers::pi;
            samples[n] = std::complex<float>{std::polar(100.0, turn * line_hz * t) +
                                             std::polar(1.0, turn * (line_hz + 12.0) * t)};
        }
        const Samples out = conditioned(samples, {line_hz});
        double power = 0.0;
        for (std::size_t n = 32768; n < out.size(); ++n) power += std::norm(std::complex<double>{out[n]}) / 8192.0;
        CHECK(power == Approx(1.0).margin(0.1));
    }
}

}  // namespace telemetry_sample_conditioner_test
