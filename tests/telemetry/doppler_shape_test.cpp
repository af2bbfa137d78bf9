// SPDX-License-Identifier: Apache-2.0
#include "telemetry/station/doppler_shape.hpp"

#include "tests/support/catch.hpp"

#include <cmath>
#include <vector>

namespace telemetry_doppler_shape_test {

using namespace aeolis::telemetry;

namespace {

double step(double time_s) {
    return time_s > 3.0 ? 1.0 : 0.0;
}

std::vector<MeasuredPoint> points(double amplitude, double wrong = 0.0) {
    std::vector<MeasuredPoint> all;
    for (int i = 0; i < 40; ++i) {
        const double time_s = 0.125 * i;
        const double noise = wrong * (i % 2 == 0 ? 1.0 : -1.0);
        all.push_back({time_s, 1000.0 - 7.0 * time_s + amplitude * step(time_s) + noise, 0.1});
    }
    return all;
}

}  // namespace

TEST_CASE("the amplitude of a shape is found beside a polynomial, with its deviation", "[station][tones]") {
    const auto found = amplitude_of(step, points(5.0), 1, 1.0);
    REQUIRE(found);
    CHECK(found->value == Approx(5.0));
    CHECK(found->sigma > 0.0);
    const auto shared = amplitude_of(step, points(5.0), 1, 4.0);
    CHECK(shared->sigma == Approx(2.0 * found->sigma));
    const auto wrong = amplitude_of(step, points(5.0, 3.0), 1, 1.0);  // what the fit leaves is more than was told
    CHECK(wrong->sigma > 10.0 * found->sigma);
}

TEST_CASE("a shape that a polynomial has as well, and too few points, have no amplitude", "[station][tones]") {
    CHECK_FALSE(amplitude_of([](double time_s) { return 2.0 * time_s; }, points(5.0), 1, 1.0));
    const auto all = points(5.0);
    CHECK_FALSE(amplitude_of(step, std::span{all}.first(3), 1, 1.0));
    CHECK_FALSE(amplitude_of(step, {}, 1, 1.0));
}

}  // namespace telemetry_doppler_shape_test
