// SPDX-License-Identifier: Apache-2.0
#include "simulation/vehicle/separated_bodies.hpp"

#include "common/time.hpp"
#include "simulation/devices/load.hpp"
#include "simulation/venues/gnc_alone.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/simulation/truth_pilot.hpp"
#include "tests/support/catch.hpp"

#include <array>
#include <cmath>
#include <optional>

namespace simulation_separated_bodies_test {

using namespace aeolis;
using namespace aeolis::simulation;

namespace {

constexpr double ground_m = 3391148.0;
const Vector3 up = Vector3::UnitX();

PointMass at_height(double height_m, double descent_mps) {
    return {(ground_m + height_m) * up, -descent_mps * up};
}

struct Still {
    Terrain terrain{tests::undisturbed_scenario(), Random{1, 0, Stream::terrain}};
    Atmosphere atmosphere{tests::gale_scenario().density_scale};
    Wind wind{0.0, 0.0, 0.0, Random{1, 0, Stream::wind}, Gusts{0.0, Random{1, 0, Stream::gust}}};

    void tick(SeparatedBody& body, const Vector3& p_MoB_M) const { body.tick(p_MoB_M, {}, atmosphere, wind, terrain); }
};

}  // namespace

TEST_CASE("a backshell under its parachute comes down at the terminal speed of its mass, and stays where it lands",
          "[simulation][separated]") {
    const Still air;
    SeparatedBody backshell{10.0, 40.0};
    backshell.release(at_height(1660.0, 79.0), 349.0, 205.0);
    const auto fly = [&](double for_s) {
        for (double t = 0.0; t < for_s; t += seconds_per_tick) air.tick(backshell, ground_m * up);
    };
    fly(40.0);
    const double height_m = backshell.at().p_MoB_M.norm() - ground_m;
    const double terminal_mps = std::sqrt(2.0 * 349.0 * 3.71 / (air.atmosphere.at(height_m).density_kgm3 * 205.0));
    CHECK(backshell.at().v_MB_M.norm() == Approx(terminal_mps).epsilon(0.01));
    fly(60.0);
    CHECK(backshell.at().p_MoB_M.norm() == Approx(ground_m));
    CHECK(backshell.at().v_MB_M.isZero());
}

TEST_CASE("a backshell under its parachute glides on as the parachute lifts, in a circle as its plane of lift turns",
          "[simulation][separated]") {
    const Still air;
    // The plane of lift turns by 4.5 deg/s. At V the air turns the velocity to where it pulls within V/g, so that the
    // glide is that much slower than lift over drag.
    constexpr double turns_rps = 4.5 * 3.14159265358979 / 180.0, turn_s = 80.0;
    const auto glides = [&](const std::optional<ParachuteLift>& lift) {
        SeparatedBody backshell{10.0, 40.0};
        backshell.release(at_height(7000.0, 79.0), 349.0, 205.0, lift);
        const auto fly = [&](double for_s) {
            for (double t = 0.0; t < for_s; t += seconds_per_tick) air.tick(backshell, ground_m * up);
        };
        const auto level_of = [](const Vector3& v) { return Vector3{v - v.x() * up}; };
        fly(40.0);
        const Vector3 from = level_of(backshell.at().p_MoB_M);
        const double sinks_mps = -backshell.at().v_MB_M.x();
        const double level_mps = level_of(backshell.at().v_MB_M).norm();
        fly(0.5 * turn_s);
        const double across_m = (level_of(backshell.at().p_MoB_M) - from).norm();
        fly(0.5 * turn_s);
        return std::array{level_mps / sinks_mps, across_m, (level_of(backshell.at().p_MoB_M) - from).norm(), sinks_mps};
    };
    const auto [slope, across_m, returned_m, sinks_mps] = glides(ParachuteLift{Vector3::UnitY(), 100.0, 0.0, 0.17});
    const double slope_expected = 0.17 / std::hypot(1.0, turns_rps * sinks_mps / 3.71);
    CHECK(slope == Approx(slope_expected).epsilon(0.05));
    CHECK(across_m == Approx(2.0 * slope_expected * sinks_mps / turns_rps).epsilon(0.15));
    CHECK(returned_m < 0.2 * across_m);
    CHECK(glides({})[1] < 5.0);  // Mars turns below it
}

TEST_CASE("a body that does not get clear in time has struck the vehicle", "[simulation][separated]") {
    const Still air;
    SeparatedBody stuck{10.0, 40.0};
    stuck.release(at_height(1660.0, 79.0), 349.0, 205.0);
    for (double t = 0.0; t < SeparatedBody::clear_within_s; t += seconds_per_tick) {
        CHECK_FALSE(stuck.struck());
        air.tick(stuck, stuck.at().p_MoB_M);
    }
    air.tick(stuck, stuck.at().p_MoB_M);
    CHECK(stuck.struck());
}

TEST_CASE("the rover on its bridle is watched as the stage is", "[simulation][separated]") {
    const Still air;
    SeparatedBody backshell{10.0, 40.0};
    backshell.release(at_height(1660.0, 79.0), 349.0, 205.0);
    const auto tick = [&](double stage_m, std::optional<PointMass> rover) {
        backshell.tick(backshell.at().p_MoB_M + stage_m * up, rover, air.atmosphere, air.wind, air.terrain);
    };
    for (int i = 0; i < 64; ++i) tick(100.0, {});
    CHECK_FALSE(backshell.struck());
    tick(99.0, backshell.at());
    CHECK(backshell.struck());
}

TEST_CASE("steps of a sixteenth of a second fly a separated body as steps of a tick do, within a centimetre",
          "[simulation][separated]") {
    const Still air;
    SeparatedBody backshell{10.0, 40.0};
    backshell.release(at_height(1660.0, 79.0), 349.0, 205.0);
    PointMass fine = at_height(1660.0, 79.0);
    for (int tick = 0; tick < 640; ++tick) {
        air.tick(backshell, ground_m * up);
        fine = runge_kutta_step(fine, seconds_per_tick, [&](double, const Vector3& p, const Vector3& v) -> Vector3 {
            return -(0.5 * air.atmosphere.at(p.norm() - ground_m).density_kgm3 * 205.0 / 349.0 * v.norm()) * v;
        });
    }
    CHECK((backshell.at().p_MoB_M - fine.p_MoB_M).norm() < 0.01);
}

TEST_CASE("only who has got clear can be struck, by coming within its size again", "[simulation][separated]") {
    const Still air;
    SeparatedBody body{5.0, 15.0};
    const PointMass start = at_height(100000.0, 0.0);
    body.release(start, 385.0, 0.0);
    const auto vehicle_at = [&](double distance_m) { air.tick(body, start.p_MoB_M + distance_m * up); };
    for (const double leaving_m : {1.0, 4.0, 2.0, 14.0, 4.0}) vehicle_at(leaving_m);
    CHECK_FALSE(body.least_m());
    for (const double distance_m : {16.0, 20.0, 8.0, 12.0}) vehicle_at(distance_m);
    REQUIRE(body.least_m());
    CHECK(*body.least_m() == Approx(8.0).margin(0.1));
    CHECK_FALSE(body.struck());
    vehicle_at(4.0);
    CHECK(body.struck());
}

TEST_CASE("in a landing nothing that was let go is met again", "[simulation][separated]") {
    tests::TruthPilot pilot{tests::undisturbed_scenario(620.0)};
    pilot.run();
    INFO(pilot.world.outcome_reason());
    CHECK(pilot.world.outcome() == Outcome::touchdown);
    const SeparationReport separation = pilot.world.separation();
    CHECK(separation.struck == nullptr);
    REQUIRE(separation.backshell_least_m);
    CHECK(*separation.backshell_least_m > 50.0);
}

TEST_CASE("where the stage glides otherwise than the wind blows, it keeps away from its backshell nonetheless",
          "[simulation][separated][gnc][R27]") {
    // Case 490 of the campaign with seed 1: its stage moved west by the glide, and the wind blew east.
    Scenario scenario = tests::gale_scenario();
    scenario.disperse_before_entry_s = 10.0;
    World world{scenario, 1};
    GncAlone gnc{load_for(scenario), world.solution(), world.sclk()};
    while (world.sclk() < scenario.entry_sclk - 10.0) world.advance(gnc.cycle(world.sense()));
    gnc.shift_navigation(world.disperse(1, 490));
    std::optional<bool> wind_known;
    while (world.outcome() == Outcome::running) {
        world.advance(gnc.cycle(world.sense()));
        for (const auto& condition : gnc.told().sidestep)
            if (condition.quantity == flight::Quantity::wind_known) wind_known = condition.value == 1.0;
    }
    CHECK(world.outcome() == Outcome::touchdown);
    CHECK(wind_known == true);
    REQUIRE(world.separation().backshell_least_m);
    CHECK(*world.separation().backshell_least_m > 280.0);
}

TEST_CASE("it is the sidestep that keeps the stage from its backshell", "[simulation][separated][gnc]") {
    const Scenario scenario = tests::undisturbed_scenario(620.0);
    const auto nearest_m = [&](double divert_m) {
        World world{scenario, 1};
        flight::Load load = load_for(scenario);
        load.divert_m = divert_m;
        GncAlone gnc{load, world.solution(), world.sclk()};
        while (world.outcome() == Outcome::running) world.advance(gnc.cycle(world.sense()));
        const SeparationReport separation = world.separation();
        REQUIRE(separation.backshell_least_m);
        return *separation.backshell_least_m;
    };
    const double without_m = nearest_m(0.0), with_m = nearest_m(304.0);
    CAPTURE(without_m, with_m);
    CHECK(with_m > without_m + 200.0);
}

}  // namespace simulation_separated_bodies_test
