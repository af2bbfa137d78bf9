// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/powered_descent/divert.hpp"
#include "tests/support/catch.hpp"

namespace flight_gnc_divert_test {

using namespace aeolis::flight::gnc;
using namespace aeolis::flight::gnc::powered_descent;

TEST_CASE("a sidestep of 304 m from rest peaks at 30 m/s in mid-way", "[gnc][R27]") {
    Divert divert;
    divert.start({304.0, 0.0, 0.0}, Vector3::Zero(), 18.6);
    CHECK(divert.velocity_M(9.3).x() == Approx(1.875 * 304.0 / 18.6));  // closed form of the quintic
    CHECK(divert.velocity_M(9.3).x() == Approx(30.0).epsilon(0.03));    // [facts]
    CHECK(divert.position_M(9.3).x() == Approx(152.0));
}

TEST_CASE("whatever the start, it ends at rest where it was meant to", "[gnc][R27]") {
    Divert divert;
    const Vector3 v0(-12.0, 7.0, 3.0), to(100.0, -250.0, 20.0);
    divert.start(to, v0, 18.0);
    CHECK((divert.position_M(18.0) - to).norm() < 1e-9);
    CHECK(divert.velocity_M(18.0).norm() < 1e-9);
    CHECK((divert.velocity_M(0.0) - v0).norm() < 1e-12);
    CHECK(divert.acceleration_M(1e-6).norm() < 1e-4);
    CHECK(divert.acceleration_M(18.0 - 1e-6).norm() < 1e-4);
}

TEST_CASE("velocity is the slope of position and acceleration that of velocity", "[gnc][R27]") {
    Divert divert;
    divert.start({304.0, 10.0, 0.0}, {3.0, 4.0, 0.0}, 18.6);
    for (const double t : {1.0, 7.0, 15.0}) {
        CHECK(((divert.position_M(t + 1e-4) - divert.position_M(t - 1e-4)) / 2e-4 - divert.velocity_M(t)).norm() <
              1e-5);
        CHECK(((divert.velocity_M(t + 1e-4) - divert.velocity_M(t - 1e-4)) / 2e-4 - divert.acceleration_M(t)).norm() <
              1e-5);
    }
}

TEST_CASE("azimuth goes from north to east", "[gnc][R27]") {
    const Vector3 p(3.4e6, 0.0, 0.0);
    CHECK((azimuth_direction(p, 0.0) - Vector3::UnitZ()).norm() < 1e-12);
    CHECK((azimuth_direction(p, pi / 2) - Vector3::UnitY()).norm() < 1e-12);
}

}  // namespace flight_gnc_divert_test
