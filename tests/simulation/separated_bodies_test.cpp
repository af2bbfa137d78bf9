// SPDX-License-Identifier: Apache-2.0
#include "simulation/vehicle/separated_bodies.hpp"

#include "common/time.hpp"
#include "simulation/devices/load.hpp"
#include "simulation/venues/gnc_alone.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/simulation/truth_pilot.hpp"
#include "tests/support/catch.hpp"

#include <cmath>

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
