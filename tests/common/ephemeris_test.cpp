// SPDX-License-Identifier: Apache-2.0
#include "common/ephemeris.hpp"

#include "tests/support/catch.hpp"

#include <cmath>
#include <numbers>

namespace common_ephemeris_test {

using namespace aeolis;

namespace {

/// A body on a circle of 4000 km about Mars, 100 minutes a turn, as states `step_s` apart.
Ephemeris circle(Interpolation interpolation, std::size_t degree, double step_s, std::size_t count) {
    Ephemeris ephemeris;
    ephemeris.interpolation = interpolation;
    ephemeris.degree = degree;
    const double rate = 2.0 * std::numbers::pi / 6000.0;
    for (std::size_t i = 0; i < count; ++i) {
        const double t = static_cast<double>(i) * step_s, angle = rate * t;
        ephemeris.states.push_back({{t},
                                    {4000.0 * std::cos(angle), 4000.0 * std::sin(angle), 0.0},
                                    {-4000.0 * rate * std::sin(angle), 4000.0 * rate * std::cos(angle), 0.0}});
    }
    ephemeris.start = ephemeris.states.front().time;
    ephemeris.stop = ephemeris.states.back().time;
    return ephemeris;
}

}  // namespace

TEST_CASE("a polynomial through states is the curve that they are of", "[ephemeris]") {
    for (const auto& [ephemeris, off_km] : {std::pair{circle(Interpolation::hermite, 7, 60.0, 30), 1e-8},
                                            {circle(Interpolation::hermite, 3, 60.0, 30), 2e-4},
                                            {circle(Interpolation::lagrange, 8, 60.0, 30), 1e-6},
                                            {circle(Interpolation::hermite, 7, 60.0, 2), 2e-4}}) {
        const auto exact = circle(Interpolation::hermite, 7, 7.0, 300);
        for (const EphemerisState& state : exact.states) {
            const auto found = state_at(ephemeris, state.time);
            if (state.time > ephemeris.stop) {
                CHECK_FALSE(found);
                continue;
            }
            REQUIRE(found);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                CHECK(std::abs(found->position_km.at(axis) - state.position_km.at(axis)) < off_km);
                CHECK(std::abs(found->velocity_kmps.at(axis) - state.velocity_kmps.at(axis)) < off_km);
            }
        }
    }
    CHECK_FALSE(state_at(circle(Interpolation::hermite, 7, 60.0, 30), {-1e-3}));
    CHECK_FALSE(state_at(Ephemeris{}, {0.0}));
}

TEST_CASE("an attitude between two is on the short way from one to the other", "[ephemeris]") {
    AttitudeHistory history;
    history.stop = {10.0};
    const auto about_z = [](double degrees, double sign) {
        const double half = degrees * std::numbers::pi / 360.0;
        return std::array{sign * std::cos(half), 0.0, 0.0, sign * std::sin(half)};
    };
    history.states = {{{0.0}, about_z(10.0, 1.0), std::array{0.0, 0.0, 0.1}},
                      {{10.0}, about_z(30.0, -1.0), std::array{0.0, 0.0, 0.3}}};
    const auto middle = attitude_at(history, {5.0});
    REQUIRE(middle);
    const auto wanted = about_z(20.0, 1.0);
    for (std::size_t i = 0; i < 4; ++i) CHECK(std::abs(middle->q_BA.at(i) - wanted.at(i)) < 1e-12);
    CHECK(std::abs(middle->w_AB_B_rps->at(2) - 0.2) < 1e-12);
    CHECK_FALSE(attitude_at(history, {10.1}));
    CHECK(attitude_at(history, {10.0})->q_BA == history.states[1].q_BA);
}

}  // namespace common_ephemeris_test
