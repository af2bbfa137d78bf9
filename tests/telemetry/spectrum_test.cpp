// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/spectrum.hpp"
#include "tests/support/catch.hpp"

namespace telemetry_spectrum_test {

using namespace aeolis::telemetry;

TEST_CASE("lengths for the transform have no prime factor above 5", "[tones]") {
    CHECK(smooth_length(1) == 8);
    CHECK(smooth_length(320) == 320);
    CHECK(smooth_length(321) == 324);
    CHECK(smooth_length(2000) == 2000);
    CHECK(smooth_length(2001) == 2025);
}

TEST_CASE("a parabola's peak lies within half a step, and a valley has none", "[tones]") {
    CHECK(peak_offset(1.0, 2.0, 1.0) == 0.0);
    CHECK(peak_offset(1.0, 2.0, 2.0) == Approx(0.5));
    CHECK(peak_offset(-(1.2 * 1.2), -(0.2 * 0.2), -(0.8 * 0.8)) == Approx(0.2));
    CHECK(peak_offset(2.0, 1.0, 2.0) == 0.0);
    CHECK(peak_offset(1.0, 1.0, 1.0) == 0.0);
}

}  // namespace telemetry_spectrum_test
