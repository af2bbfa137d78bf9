// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/x_band_antenna.hpp"

#include "tests/support/catch.hpp"

namespace simulation_x_band_antenna_test {

using namespace aeolis::simulation;

namespace {

Vector3 off_axis(double degrees, double around_degrees = 0.0) {
    const double a = degrees * degree_rad, b = around_degrees * degree_rad;
    return {std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), -std::cos(a)};
}

}  // namespace

TEST_CASE("an antenna has half its power 60 degrees off its best direction, whatever the roll",
          "[simulation][tones][R31]") {
    CHECK(x_band_gain(XBandAntenna::entry, off_axis(0.0)) == Approx(1.0));
    CHECK(x_band_gain(XBandAntenna::parachute, off_axis(70.0)) == Approx(1.0));
    for (const double around : {0.0, 77.0, 200.0}) {
        CHECK(x_band_gain(XBandAntenna::entry, off_axis(60.0, around)) == Approx(0.5));
        CHECK(x_band_gain(XBandAntenna::parachute, off_axis(10.0, around)) == Approx(0.5));
    }
}

TEST_CASE("behind the vehicle little is left, and never nothing", "[simulation][tones][R31]") {
    CHECK(x_band_gain(XBandAntenna::entry, off_axis(180.0)) == Approx(0.01));
    CHECK(x_band_gain(XBandAntenna::parachute, off_axis(180.0)) <
          x_band_gain(XBandAntenna::parachute, off_axis(130.0)));
}

TEST_CASE(
    "each antenna is the better one where it is selected: Earth behind in entry, at the horizon under the parachute",
    "[simulation][tones][R31]") {
    CHECK(x_band_gain(XBandAntenna::entry, off_axis(25.0)) > x_band_gain(XBandAntenna::parachute, off_axis(25.0)));
    CHECK(x_band_gain(XBandAntenna::parachute, off_axis(92.0)) > x_band_gain(XBandAntenna::entry, off_axis(92.0)));
}

}  // namespace simulation_x_band_antenna_test
