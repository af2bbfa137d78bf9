// SPDX-License-Identifier: Apache-2.0
#include "common/ephemeris.hpp"

#include "common/mars_orientation.hpp"
#include "tests/support/catch.hpp"

#include <cmath>
#include <numbers>
#include <random>

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

TEST_CASE("a microsecond of UTC goes to ephemeris time and back, also about a leap second", "[ephemeris]") {
    // The instant of entry of 2012 by both clocks: 35 leap seconds, 32.184 s, and TDB about a millisecond off TT.
    const auto entry = scet_from_text("2012-08-06T05:10:47.4");
    REQUIRE(entry);
    CHECK(leap_seconds_at(*entry) == 35);
    CHECK(std::abs(ephemeris_time_of(*entry).seconds - (397501847.4 + 35.0 + 32.184)) < 0.002);
    CHECK_FALSE(leap_seconds_at(*scet_from_text("1971-12-31T23:59:59")));
    CHECK(leap_seconds_at(*scet_from_text("1972-01-01T00:00:00")) == 10);
    CHECK(leap_seconds_at(*scet_from_text("2016-12-31T23:59:59")) == 36);
    CHECK(leap_seconds_at(*scet_from_text("2017-01-01T00:00:00")) == 37);
    std::mt19937 random{11};
    const std::int64_t leap_us = scet_from_text("2012-07-01T00:00:00")->microseconds;
    for (int i = 0; i < 2'000; ++i) {
        const Scet near{leap_us + static_cast<std::int64_t>(random() % 80'000'000) - 40'000'000};
        const Scet far{static_cast<std::int64_t>(random()) * 200'000 - 300'000'000'000'000};
        for (const Scet utc : {near, far}) {
            CAPTURE(utc.microseconds);
            CHECK(std::abs(utc_of(ephemeris_time_of(utc)).microseconds - utc.microseconds) <= 1);
        }
    }
}

TEST_CASE("an instant is written and read in each time system", "[ephemeris]") {
    const EphemerisTime time = ephemeris_time_of(*scet_from_text("2012-08-06T05:10:47.4"));
    CHECK(calendar_text(time, TimeSystem::utc) == "2012-08-06T05:10:47.400000");
    CHECK(calendar_text(time, TimeSystem::tai) == "2012-08-06T05:11:22.400000");
    CHECK(calendar_text(time, TimeSystem::tt) == "2012-08-06T05:11:54.584000");
    CHECK(calendar_text(time, TimeSystem::gps) == "2012-08-06T05:11:03.400000");
    for (const auto system : {TimeSystem::utc, TimeSystem::tai, TimeSystem::tt, TimeSystem::tdb, TimeSystem::gps}) {
        CHECK(time_system_named(name_of(system)) == system);
        const auto read = ephemeris_time_from_text(calendar_text(time, system), system);
        REQUIRE(read);
        CHECK(std::abs(*read - time) < 2e-6);
    }
    CHECK(calendar_text({0.0}, TimeSystem::tdb) == "2000-01-01T12:00:00.000000");
    CHECK(calendar_text({-86400.0 * 1.5 - 1e-6}, TimeSystem::tdb) == "1999-12-30T23:59:59.999999");
    CHECK_FALSE(ephemeris_time_from_text("yesterday", TimeSystem::utc));
    CHECK_FALSE(time_system_named("UT1"));
}

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

TEST_CASE("a state goes to rotating Mars and back, and what stands there moves in J2000", "[ephemeris][frames]") {
    const EphemerisTime time{397501914.56};
    const PositionAndVelocity standing{{3390.0, 100.0, -270.0}, {0.0, 0.0, 0.0}};
    const auto inertial = to_j2000(standing, time);
    const double speed = std::hypot(inertial.velocity[0], inertial.velocity[1], inertial.velocity[2]);
    CHECK(std::abs(speed - std::hypot(3390.0, 100.0) * 7.0882180e-5) < 1e-6);  // [km/s], a turn in 24 h 37 min 22.66 s
    // A second later it is where that velocity has taken it.
    const auto later = to_j2000(standing, time + 1.0);
    for (std::size_t axis = 0; axis < 3; ++axis)
        CHECK(std::abs(later.position.at(axis) - inertial.position.at(axis) - inertial.velocity.at(axis)) < 1e-4);
    const auto back = to_mars_fixed(inertial, time);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        CHECK(std::abs(back.position.at(axis) - standing.position.at(axis)) < 1e-9);
        CHECK(std::abs(back.velocity.at(axis)) < 1e-12);
    }
}

}  // namespace common_ephemeris_test
