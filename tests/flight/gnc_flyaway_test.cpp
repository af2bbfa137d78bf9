// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/flyaway/flyaway.hpp"
#include "flight/gnc/mars.hpp"
#include "tests/support/catch.hpp"

#include <cmath>

namespace flight_gnc_flyaway_test {

using namespace aeolis::flight::gnc;
constexpr aeolis::flight::Parameters parameters;

namespace {
const Vector3 p(3391160.0, 0.0, 0.0);
}

TEST_CASE("it clears the rover upright and then pitches to 45° northwards", "[gnc][R27]") {
    CHECK_FALSE(flyaway::command(parameters, 0.1, p).full);
    CHECK(flyaway::command(parameters, 0.3, p).full);
    CHECK((flyaway::command(parameters, 1.9, p).direction_M - Vector3::UnitX()).norm() < 1e-12);
    const Vector3 late = flyaway::command(parameters, 5.0, p).direction_M;
    CHECK(late.x() == Approx(std::cos(45.0 * degree)));
    CHECK(late.z() == Approx(std::sin(45.0 * degree)));
}

TEST_CASE("a burn of 6.66 s throws the stage 450 m and more", "[gnc][R27]") {
    // A point of 1070 kg under 4 × 3060 N, then thrown: flat ground, no air.
    Vector3 x = 8.0 * Vector3::UnitX(), v = Vector3::Zero();
    constexpr double dt = 0.01;
    double t = 0.0;
    while (x.x() > 0.0 && t < 200.0) {
        const flyaway::Command command = flyaway::command(parameters, t, p);
        const double thrust_mps2 = t > 6.59 ? 0.0 : command.full ? 4.0 * 3060.0 / 1070.0 : mars_weight_mps2;
        v += dt * (thrust_mps2 * command.direction_M - mars_weight_mps2 * Vector3::UnitX());
        x += dt * v;
        t += dt;
    }
    CHECK(x.z() >= 450.0);  // [facts]
}

}  // namespace flight_gnc_flyaway_test
