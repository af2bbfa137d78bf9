// SPDX-License-Identifier: Apache-2.0
#include "simulation/vehicle/stage_and_rover.hpp"

#include "common/time.hpp"
#include "simulation/devices/load.hpp"
#include "simulation/vehicle/bridle.hpp"
#include "simulation/vehicle/rover_wheels.hpp"
#include "simulation/vehicle/vehicle.hpp"
#include "simulation/venues/gnc_alone.hpp"
#include "simulation/world.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/gnc_venue.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace simulation_sky_crane_test {

using namespace aeolis;
using namespace aeolis::simulation;

namespace {

constexpr double rover_kg = 899.0;
constexpr double weight_mps2 = 3.71;
constexpr double paid_out_s = 99.0;

/// A bridle that is let out whole, from a point that does not move; without Mars.
struct Pendulum {
    Bridle bridle = [] {
        Bridle started;
        started.start(0.0);
        return started;
    }();
    Vector3 p = Vector3::Zero(), v = Vector3::Zero();

    void fly(double for_s, double step_s = 0.005) {
        for (double t = 0.0; t < for_s - 0.5 * step_s; t += step_s) {
            const auto a = [&](const Vector3& at, const Vector3& by) -> Vector3 {
                return bridle.pull_N(paid_out_s, rover_kg, at, by) / rover_kg - weight_mps2 * Vector3::UnitZ();
            };
            const Vector3 a1 = a(p, v), a2 = a(p + 0.5 * step_s * v, v + 0.5 * step_s * a1);
            p += step_s * (v + 0.5 * step_s * a1);
            v += step_s * a2;
        }
    }
};

/// The vehicle far above the air as it hangs after rover separation, turning a little.
Vehicle hanging_above_the_air() {
    using flight::PyroId;
    const Scenario scenario = tests::undisturbed_scenario();
    const Horizon local = horizon(place(-4.6 * degree_rad, 137.4 * degree_rad, 1.0));
    Vehicle vehicle{scenario,
                    {(scenario.target.radius_m + 400000.0) * local.up, 100.0 * local.east},
                    Quaternion::FromTwoVectors(Vector3::UnitZ(), -local.up),
                    1,
                    0};
    for (const PyroId pyro : {PyroId::cruise_stage_separation, PyroId::cruise_balance_1, PyroId::cruise_balance_2,
                              PyroId::entry_balance_1, PyroId::entry_balance_2, PyroId::entry_balance_3,
                              PyroId::heatshield_separation, PyroId::backshell_separation, PyroId::rover_separation})
        vehicle.fire(pyro, 0.0);
    return vehicle;
}

struct Seen {
    double least = 1e9, most = 0.0, sum = 0.0;
    int count = 0;
    void add(double value) {
        least = std::min(least, value);
        most = std::max(most, value);
        sum += value;
        ++count;
    }
    double mean() const { return sum / count; }
};

/// Magnitudes that the rover's own IMU tells in a landing.
struct RoverFelt {
    double on_stage_apart_mps2 = 0.0;  ///< from what the stage feels
    Seen hanging_mps2, hanging_rps, standing_mps2, standing_rps;

    void add(const tests::GncVenue& venue) {
        const World& world = venue.world();
        const auto& told = venue.last_inputs().rover_imu;
        const double felt_mps2 = std::exchange(sensed_mps2_, world.truth().sensed_mps2);
        if (!told) return;
        const double force_mps2 = vector3(told->force_mps2).norm(), rate_rps = vector3(told->rate_rps).norm();
        const double e_s = world.truth().e_s;
        if (e_s > 0.0 && e_s < 300.0)
            on_stage_apart_mps2 = std::max(on_stage_apart_mps2, std::abs(force_mps2 - felt_mps2));
        if (!world.contact() && world.inspect().bridle_m > 7.49) {
            hanging_mps2.add(force_mps2);
            hanging_rps.add(rate_rps);
        }
        if (world.contact() && world.sclk() - *world.contact() > 1.0) {
            standing_mps2.add(force_mps2);
            standing_rps.add(rate_rps);
        }
    }

  private:
    double sensed_mps2_ = 0.0;  // when the inputs were taken
};

}  // namespace

TEST_CASE("a hanging rover stretches the bridle by its weight, and the bridle never pushes",
          "[simulation][sky_crane]") {
    Pendulum rover;
    rover.p = -7.7 * Vector3::UnitZ();
    rover.fly(5.0);
    CHECK(rover.bridle.pull_N(paid_out_s, rover_kg, rover.p, rover.v).z() ==
          Approx(rover_kg * weight_mps2).epsilon(1e-3));
    CHECK(rover.p.z() == Approx(-7.7).margin(1e-3));
    CHECK(rover.bridle.pull_N(paid_out_s, rover_kg, -7.6 * Vector3::UnitZ(), Vector3::Zero()).isZero());
    CHECK(rover.bridle.pull_N(paid_out_s, rover_kg, -7.7 * Vector3::UnitZ(), 9.0 * Vector3::UnitZ()).isZero());
}

TEST_CASE("the rover swings with the period of a pendulum of the bridle's length", "[simulation][sky_crane]") {
    Pendulum rover;
    rover.p = 7.7 * Vector3{std::sin(0.05), 0.0, -std::cos(0.05)};
    const double period_s = 2.0 * std::numbers::pi * std::sqrt(7.7 / weight_mps2);
    rover.fly(0.25 * period_s);
    CHECK(std::abs(rover.p.x()) < 0.01);
    CHECK(rover.v.x() == Approx(-0.05 * std::sqrt(7.7 * weight_mps2)).epsilon(0.02));
    rover.fly(0.75 * period_s);
    CHECK(rover.p.x() == Approx(7.7 * std::sin(0.05)).epsilon(0.02));
}

TEST_CASE("a rover let down at three quarters of a metre a second stands without a bounce", "[simulation][sky_crane]") {
    for (const double slope_deg : {0.0, 10.0}) {
        const Vector3 normal{std::sin(slope_deg * degree_rad), 0.0, std::cos(slope_deg * degree_rad)};
        Vector3 p = Vector3::Zero(), v{0.0, 0.1, -0.75};
        double highest_m = -1.0;
        for (int i = 0; i < 2000; ++i) {
            const Vector3 push = ground_reaction_N(rover_kg, -p.dot(normal), normal, v);
            v += 0.001 * (push / rover_kg - weight_mps2 * Vector3::UnitZ());
            p += 0.001 * v;
            if (i > 100) highest_m = std::max(highest_m, p.dot(normal));
        }
        CHECK(highest_m < 0.0);
        CHECK(-p.dot(normal) == Approx(0.02 * std::cos(slope_deg * degree_rad)).epsilon(0.02));
        CHECK(v.norm() < 0.01);  // friction holds it on the slope
        CHECK(p.head<2>().norm() < 0.05);
    }
}

TEST_CASE("stage and rover keep their momentum together, whatever the bridle does between them",
          "[simulation][sky_crane]") {
    Vehicle vehicle = hanging_above_the_air();
    const double stage_kg = vehicle.configuration().rigid_kg();
    const auto together = [&] {
        const PointMass stage = vehicle.at();
        const PointMass rover = *vehicle.rover();
        const double part = rover_kg / (stage_kg + rover_kg);
        return PointMass{(1.0 - part) * stage.p_MoB_M + part * rover.p_MoB_M,
                         (1.0 - part) * stage.v_MB_M + part * rover.v_MB_M};
    };
    PointMass falls = together();
    vehicle.command({}, false, {}, true, 0.0);
    for (int i = 0; i < 1200; ++i) vehicle.step(0.005 * i, 0.005);
    falls = coast(falls, 6.0);
    CHECK((vehicle.rover()->v_MB_M - vehicle.at().v_MB_M).norm() > 0.01);  // the bridle was under load
    CHECK((together().p_MoB_M - falls.p_MoB_M).norm() < 1e-5);             // gravity differs over some metres
    CHECK((together().v_MB_M - falls.v_MB_M).norm() < 1e-5);
}

TEST_CASE("halving the step makes the error of stage and rover together sixteen times smaller",
          "[simulation][sky_crane][convergence]") {
    constexpr double stage_kg = 1100.0;
    const Inertia inertia{{800.0, 800.0, 1000.0}};
    Bridle bridle;
    bridle.start(0.0);
    const Vector3 up = Vector3::UnitX();
    StageAndRover start;
    start.stage.p_MoB_M = 3391200.0 * up;
    start.stage.q_MB = Quaternion::FromTwoVectors(Vector3::UnitZ(), -up) * rotation({0.03, 0.0, 0.0});
    start.stage.rate_B_rps = {0.02, -0.03, 0.1};
    start.rover = {start.stage.p_MoB_M - 7.905 * up, {0.05, 0.5, -0.3}};  // it bobs, without slack, and swings
    const auto flown = [&](double step_s) {
        StageAndRover both = start;
        for (int i = 0; i < static_cast<int>(std::lround(0.32 / step_s)); ++i)
            both = runge_kutta_step(both, step_s, stage_kg, inertia, rover_kg, [&](double, const StageAndRover& at) {
                const Vector3 arm_B{0.0, 0.0, Bridle::confluence_m};
                const Vector3 pull_M =
                    bridle.pull_N(paid_out_s, rover_kg, at.rover.p_MoB_M - at.stage.p_MoB_M - at.stage.q_MB * arm_B,
                                  at.rover.v_MB_M - at.stage.v_MB_M - at.stage.q_MB * at.stage.rate_B_rps.cross(arm_B));
                return StageAndRoverLoads{{(stage_kg + rover_kg) * weight_mps2 * up - pull_M,
                                           -arm_B.cross(at.stage.q_MB.conjugate() * pull_M)},
                                          pull_M};
            });
        return both;
    };
    const StageAndRover best = flown(0.00125);
    const auto errors = [&](double step_s) {
        const StageAndRover both = flown(step_s);
        return std::array{(both.rover.p_MoB_M - best.rover.p_MoB_M).norm(),
                          both.stage.q_MB.angularDistance(best.stage.q_MB)};
    };
    const auto coarse = errors(0.02), fine = errors(0.01);
    CHECK(std::log2(coarse[0] / fine[0]) == Approx(4.0).margin(0.5));
    CHECK(std::log2(coarse[1] / fine[1]) == Approx(4.0).margin(0.5));
    CHECK(errors(0.005)[0] < 1e-5);  // as it is flown
}

TEST_CASE(
    "in a landing the rover hangs quietly, touches as slowly as the stage sinks, and takes its weight off the engines",
    "[simulation][sky_crane][gnc]") {
    tests::GncVenue venue(tests::undisturbed_scenario(620.0), 1);
    double most_swing_deg = 0.0, thrust_before_N = 0.0, thrust_after_N = 0.0;
    RoverFelt felt;
    while (venue.running()) {
        venue.step();
        felt.add(venue);
        const auto seen = venue.world().inspect();
        most_swing_deg = std::max(most_swing_deg, seen.swing_deg);
        const auto contact = venue.world().contact();
        if (!contact && seen.bridle_m > 7.4) thrust_before_N = seen.thrust_N;
        if (contact && venue.told().mode == flight::gnc::Mode::sky_crane) thrust_after_N = seen.thrust_N;
    }
    INFO(venue.world().outcome_reason());
    REQUIRE(venue.world().outcome() == Outcome::touchdown);
    CHECK(most_swing_deg < 5.0);
    CHECK(thrust_before_N - thrust_after_N == Approx(rover_kg * weight_mps2).epsilon(0.1));
    CHECK(venue.world().touchdown()->vertical_mps == Approx(0.75).margin(0.05));
    CHECK(venue.world().touchdown()->horizontal_mps < 0.2);
    // What the rover's own IMU tells of it, without errors.
    CHECK(felt.on_stage_apart_mps2 < 1e-9);
    CHECK(felt.hanging_mps2.mean() == Approx(weight_mps2).epsilon(0.02));
    CHECK(felt.hanging_rps.most > 5.0 * mars_spin_rps);  // it swings a little
    CHECK(felt.hanging_rps.most < 0.2);
    CHECK(felt.standing_mps2.most == Approx(weight_mps2).margin(0.02));
    CHECK(felt.standing_mps2.least == Approx(felt.standing_mps2.most).epsilon(1e-3));
    CHECK(felt.standing_rps.most == Approx(mars_spin_rps));
}

TEST_CASE("GNC damps a swing that something has started, by nulling the stage's drift",
          "[simulation][sky_crane][gnc]") {
    const Scenario scenario = tests::undisturbed_scenario(620.0);
    World world{scenario, 1};
    GncAlone gnc{load_for(scenario), world.solution(), world.sclk()};
    double since_s = 0.0, early_deg = 0.0, late_deg = 0.0;
    while (world.outcome() == Outcome::running) {
        flight::DeviceOutputs out = gnc.cycle(world.sense());
        const auto seen = world.inspect();
        if (seen.bridle_m > 7.49 && !world.contact()) {
            since_s += seconds_per_tick;
            if (since_s < 0.7) {  // two engines across from each other go astray
                out.engines.throttle[0] += 0.1;
                out.engines.throttle[4] -= 0.1;
            }
            if (since_s < 4.0) early_deg = std::max(early_deg, seen.swing_deg);
            if (since_s > 12.0) late_deg = std::max(late_deg, seen.swing_deg);
        }
        world.advance(out);
    }
    INFO(world.outcome_reason());
    CHECK(world.outcome() == Outcome::touchdown);
    CHECK(early_deg > 5.0);
    CHECK(late_deg < 0.35 * early_deg);
    CHECK(world.touchdown()->horizontal_mps < 0.2);
}

}  // namespace simulation_sky_crane_test
