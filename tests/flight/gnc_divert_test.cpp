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

TEST_CASE("whatever the drift, it ends at rest, aside from where the drift alone would end", "[gnc][R27]") {
    Divert divert;
    const Vector3 v0(-12.0, 7.0, 3.0), to(100.0, -250.0, 20.0);
    divert.start(to, v0, 18.0);
    CHECK((divert.position_M(18.0) - (to + 9.0 * v0)).norm() < 1e-9);
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

TEST_CASE("a drift from any side makes the sidestep no dearer: the velocity to gain and lose is the same",
          "[gnc][R27]") {
    const auto gained_mps = [](const Vector3& v0) {
        Divert divert;
        divert.start({304.0, 0.0, 0.0}, v0, 18.0);
        return (divert.velocity_M(9.0) - 0.5 * v0).norm();
    };
    for (const Vector3& v0 : {Vector3{20.0, 0.0, 0.0}, Vector3{-20.0, 0.0, 0.0}, Vector3{0.0, 20.0, 0.0}})
        CHECK(gained_mps(v0) == Approx(gained_mps(Vector3::Zero())));
}

TEST_CASE("a sidestep over whose end the backshell will drift, then or later, goes to the other side, and says why",
          "[gnc][R27][R38]") {
    constexpr aeolis::flight::Parameters parameters;
    const Vector3 divert(304.0, 0.0, 0.0);
    // With 0.4 m/s the backshell is 284 m away after 40 s more, with 0.6 m/s 275 m; with 70 m/s it has passed before.
    for (const Vector3& elsewhere : {Vector3{-30.0, 0.0, 0.0}, Vector3{0.0, 30.0, 0.0}, Vector3{0.4, 0.0, 0.0},
                                     Vector3{70.0, 0.0, 0.0}, Vector3{-8.0, 8.0, 0.0}, Vector3{0.0, 0.0, 0.0}}) {
        const auto chosen = choose_sidestep(parameters, divert, elsewhere, std::nullopt, 18.0);
        CHECK(chosen.displacement_M == divert);
        CHECK(chosen.conditions.size() == 3);
        CHECK(all_hold(chosen.conditions));
    }
    for (const Vector3& over_it : {Vector3{30.0, 0.0, 0.0}, Vector3{8.0, 8.0, 0.0}, Vector3{0.6, 0.0, 0.0}}) {
        const auto chosen = choose_sidestep(parameters, divert, over_it, std::nullopt, 18.0);
        CHECK(chosen.displacement_M == -divert);
        CHECK(chosen.conditions.size() == 4);
        CHECK(all_hold(chosen.conditions));
    }
}

TEST_CASE("where the wind is known, the backshell drifts with it and not with the stage's velocity",
          "[gnc][R27][R38]") {
    constexpr aeolis::flight::Parameters parameters;
    const Vector3 divert(304.0, 0.0, 0.0), still = Vector3::Zero(), wind(6.0, 0.0, 0.0);
    CHECK(choose_sidestep(parameters, divert, still, std::nullopt, 18.0).displacement_M == divert);
    const auto chosen = choose_sidestep(parameters, divert, still, wind, 18.0);
    CHECK(chosen.displacement_M == -divert);
    CHECK(all_hold(chosen.conditions));
    // 30 m/s of glide bring the stage 270 m on: there the wind, which is across, does not bring the backshell.
    const Vector3 glide(30.0, 0.0, 0.0), across(0.0, 6.0, 0.0);
    CHECK(choose_sidestep(parameters, divert, glide, std::nullopt, 18.0).displacement_M == -divert);
    CHECK(choose_sidestep(parameters, divert, glide, across, 18.0).displacement_M == divert);
}

TEST_CASE("a sidestep whose opposite would end still nearer to the backshell goes where it was planned",
          "[gnc][R27][R38]") {
    constexpr aeolis::flight::Parameters parameters;
    const Vector3 divert(304.0, 0.0, 0.0), v0(30.0, 0.0, 0.0), wind(6.2, 0.0, 0.0);
    // The backshell is 158 m behind the end of the stage's drift when the sidestep ends, and 90 m ahead of it 40 s on.
    const auto chosen = choose_sidestep(parameters, divert, v0, wind, 18.0);
    CHECK(chosen.displacement_M == divert);
    REQUIRE(chosen.conditions.size() == 4);
    CHECK(all_hold(chosen.conditions));
    CHECK(chosen.conditions[1].value == Approx(214.4).margin(0.1));
    CHECK(chosen.conditions[2].value == Approx(145.6).margin(0.1));
}

TEST_CASE("azimuth goes from north to east", "[gnc][R27]") {
    const Vector3 p(3.4e6, 0.0, 0.0);
    CHECK((azimuth_direction(p, 0.0) - Vector3::UnitZ()).norm() < 1e-12);
    CHECK((azimuth_direction(p, pi / 2) - Vector3::UnitY()).norm() < 1e-12);
}

}  // namespace flight_gnc_divert_test
