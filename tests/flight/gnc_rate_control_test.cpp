// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/sky_crane/rate_control.hpp"
#include "tests/support/catch.hpp"

namespace flight_gnc_rate_control_test {

using namespace aeolis::flight::gnc;
using namespace aeolis::flight::gnc::sky_crane;
constexpr aeolis::flight::Parameters parameters;

namespace {
const Vector3 up = Vector3::UnitX();
constexpr double dt = 1.0 / 64;
}  // namespace

TEST_CASE("the rate settles and drift dies out", "[gnc][R27]") {
    RateControl control;
    control.start();
    Vector3 v(-1.5, 0.8, -0.4);
    for (int i = 0; i < 64 * 8; ++i) v += dt * control.command_M(parameters, v, up, 0.75, dt);
    CHECK(v.x() == Approx(-0.75).margin(1e-3));
    CHECK((v - v.x() * up).norm() < 0.01);
}

TEST_CASE("a mass that is not as believed is taken up by the integral", "[gnc][R27]") {
    // Thrust for 2000 kg on 1930 kg: the stage feels 3.6 % too much lift.
    RateControl control;
    control.start();
    Vector3 v(-0.75, 0.0, 0.0);
    for (int i = 0; i < 64 * 6; ++i) {
        const double asked = 3.71 + control.command_M(parameters, v, up, 0.75, dt).x();
        v.x() += dt * (asked * 2000.0 / 1930.0 - 3.71);
    }
    CHECK(v.x() == Approx(-0.75).margin(0.005));
}

TEST_CASE("an acceleration command is bounded", "[gnc][R27]") {
    RateControl control;
    CHECK(control.command_M(parameters, {-50.0, 0.0, 0.0}, up, 0.75, dt).norm() <= 3.0);
}

}  // namespace flight_gnc_rate_control_test
