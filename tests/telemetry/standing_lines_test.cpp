// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/standing_lines.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/impaired_signal.hpp"

#include <cmath>
#include <limits>

namespace telemetry_standing_lines_test {

using namespace aeolis;
using namespace aeolis::telemetry;
using namespace aeolis::tests::impaired;

namespace {

/// 14 s of noise of power 1 a sample.
Samples noise(double rate_hz) {
    Signal nothing;
    nothing.rate_hz = rate_hz;
    nothing.length_s = 14.0;
    nothing.c_n0_dbhz = -60.0;
    return transmitted(nothing);
}

StandingLines looked(const Samples& samples, double rate_hz, double middle_hz) {
    StandingLines lines{rate_hz, middle_hz};
    lines.push(std::span{samples}.first(samples.size() / 3));
    lines.push(std::span{samples}.subspan(samples.size() / 3));
    return lines;
}

}  // namespace

TEST_CASE("lines that stand still are known after twelve seconds, the strongest first", "[tones][R56]") {
    constexpr double rate_hz = 8192.0;
    Samples samples = noise(rate_hz);
    add_line(samples, rate_hz, 22.0, 0.0, [](double) { return 140.3; });
    add_line(samples, rate_hz, 22.0, 3.0, [](double) { return 0.0; });
    add_line(samples, rate_hz, 22.0, 6.0, [](double) { return 500.0; });  // beyond 300 Hz
    samples[100] = {std::numeric_limits<float>::quiet_NaN(), 0.0F};
    const StandingLines lines = looked(samples, rate_hz, 100.0);
    CHECK(lines.looks() == 2);
    REQUIRE(lines.lines().size() == 2);
    CHECK(lines.lines()[0].frequency_hz == Approx(0.0).margin(0.02));
    CHECK(lines.lines()[1].frequency_hz == Approx(140.3).margin(0.02));
    CHECK(lines.lines()[0].energy > 1.5 * lines.lines()[1].energy);
    CHECK_FALSE(lines.holds_more());
    CHECK(looked(Samples(samples.begin(), samples.begin() + 80000), rate_hz, 100.0).lines().empty());
}

TEST_CASE("a carrier that moves is no standing line, and more than noise; noise alone is neither", "[tones][R56]") {
    constexpr double rate_hz = 10000.0;
    Samples samples = noise(rate_hz);
    const StandingLines nothing = looked(samples, rate_hz, 0.0);
    CHECK(nothing.lines().empty());
    CHECK_FALSE(nothing.holds_more());
    add_line(samples, rate_hz, 24.0, 0.0, [](double) { return 0.0; });
    CHECK_FALSE(looked(samples, rate_hz, 0.0).holds_more());
    add_line(samples, rate_hz, 24.0, 0.0, [](double t) { return -60.0 + 3.0 * t; });
    const StandingLines both = looked(samples, rate_hz, 0.0);
    REQUIRE(both.lines().size() == 1);
    CHECK(both.lines()[0].frequency_hz == Approx(0.0).margin(0.05));
    CHECK(both.holds_more());
}

}  // namespace telemetry_standing_lines_test
