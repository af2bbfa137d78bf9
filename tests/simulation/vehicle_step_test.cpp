// SPDX-License-Identifier: Apache-2.0
#include "simulation/vehicle/vehicle.hpp"

#include "common/time.hpp"
#include "flight/devices/effectors.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/simulation/jacobi.hpp"
#include "tests/support/catch.hpp"

#include <cmath>
#include <functional>

namespace simulation_vehicle_step_test {

using namespace aeolis;
using namespace aeolis::simulation;

// The whole of Vehicle::step: what it keeps, what pulses add, and how its error falls with the step.
namespace {

Vehicle vehicle_at(double altitude_m, const Vector3& east_north_up_mps) {
    using flight::PyroId;
    const Scenario scenario = tests::undisturbed_scenario();
    const Horizon local = horizon(place(-4.6 * degree_rad, 137.4 * degree_rad, 1.0));
    Vehicle vehicle{
        scenario,
        {(scenario.target.radius_m + altitude_m) * local.up,
         east_north_up_mps.x() * local.east + east_north_up_mps.y() * local.north + east_north_up_mps.z() * local.up},
        Quaternion::FromTwoVectors(Vector3::UnitZ(), -local.up),
        1,
        0};
    for (const PyroId pyro : {PyroId::cruise_stage_separation, PyroId::cruise_balance_1, PyroId::cruise_balance_2,
                              PyroId::entry_balance_1, PyroId::entry_balance_2, PyroId::entry_balance_3})
        vehicle.fire(pyro, 0.0);
    return vehicle;
}

/// Pulses of three thrusters that leave it tumbling about all axes.
Vehicle tumbling_above_the_air() {
    Vehicle vehicle = vehicle_at(400000.0, {3000.0, 500.0, 0.0});
    flight::ThrusterCommand pulses;
    pulses.on_s[0] = pulses.on_s[4] = pulses.on_s[7] = seconds_per_tick;
    for (int i = 0; i < 64; ++i) {
        vehicle.command(pulses, true, {}, false, i * seconds_per_tick);
        vehicle.step(i * seconds_per_tick, seconds_per_tick);
    }
    vehicle.command({}, false, {}, false, 1.0);
    vehicle.step(1.0, 0.005);
    return vehicle;
}

Vehicle flown(Vehicle vehicle, double from_s, double for_s, double step_s) {
    const auto steps = static_cast<int>(std::lround(for_s / step_s));
    for (int i = 0; i < steps; ++i) vehicle.step(from_s + i * step_s, step_s);
    return vehicle;
}

double rotation_J(const Vehicle& vehicle) {
    const Vector3& w = vehicle.body().rate_B_rps;
    return 0.5 * w.dot(vehicle.configuration().inertia().moments_B.cwiseProduct(w));
}

/// Angular momentum about its own centre, in axes that do not turn with Mars.
Vector3 spin_Nms(const Vehicle& vehicle, double time_s) {
    const Vector3 momentum_B = vehicle.configuration().inertia().moments_B.cwiseProduct(vehicle.body().rate_B_rps);
    return rotation({0.0, 0.0, mars_spin_rps * time_s}) * (vehicle.q_MB() * momentum_B);
}

/// By which power of the step the error falls.
double order(const Vehicle& start, double from_s, double for_s, double step_s,
             const std::function<double(const Vehicle&, const Vehicle&)>& apart) {
    const Vehicle best = flown(start, from_s, for_s, step_s / 16.0);
    return std::log2(apart(flown(start, from_s, for_s, step_s), best) /
                     apart(flown(start, from_s, for_s, step_s / 2.0), best));
}

double apart_m(const Vehicle& one, const Vehicle& other) {
    return (one.at().p_MoB_M - other.at().p_MoB_M).norm();
}
double apart_rad(const Vehicle& one, const Vehicle& other) {
    return one.q_MB().angularDistance(other.q_MB());
}

}  // namespace

TEST_CASE("without air and pulses a vehicle keeps its energy in turning Mars's oblate field, and its spin",
          "[simulation][vehicle][conservation]") {
    const Vehicle start = tumbling_above_the_air();
    REQUIRE(start.body().rate_B_rps.norm() > 0.1);
    const Vehicle end = flown(start, 2.0, 200.0, 0.005);
    REQUIRE(end.altitude_m() > 260000.0);
    CHECK(std::abs(tests::jacobi_m2ps2(end.at()) - tests::jacobi_m2ps2(start.at())) < 1e-3);  // of 10 MJ/kg
    CHECK(rotation_J(end) == Approx(rotation_J(start)).epsilon(1e-9));
    CHECK((spin_Nms(end, 200.0) - spin_Nms(start, 0.0)).norm() / spin_Nms(start, 0.0).norm() < 1e-8);
    CHECK(end.specific_force_M().isZero());
}

TEST_CASE("a pulse adds its impulse to the momentum, and its moment about the centre of mass to the spin",
          "[simulation][vehicle][conservation]") {
    const Vehicle start = vehicle_at(400000.0, {3000.0, 0.0, 0.0});
    for (const std::size_t thruster : {0, 3, 6}) {
        Vehicle pushed = start, coasts = start;
        flight::ThrusterCommand pulse;
        pulse.on_s[thruster] = 0.01;
        pushed.command(pulse, true, {}, false, 0.0);
        pushed = flown(pushed, 0.0, 0.05, 0.005);
        coasts = flown(coasts, 0.0, 0.05, 0.005);
        const auto mounted = flight::entry_thrusters()[thruster];
        const Vector3 impulse_B = 302.0 * 0.01 * vector3(mounted.direction_B);
        const double kg = start.configuration().total_kg();
        const Vector3 gained = kg * (start.q_MB().conjugate() * (pushed.at().v_MB_M - coasts.at().v_MB_M));
        CHECK((gained - impulse_B).norm() < 0.02 * impulse_B.norm());  // it spins at 2 rpm meanwhile
        const Vector3 drawn_from{0.0, 0.0, Configuration::at_entry(Scenario{}).centre_B_m().z()};
        const Vector3 arm = vector3(mounted.position_B_m) + drawn_from - start.configuration().centre_B_m();
        const Vector3 turned = start.q_MB().conjugate() * (spin_Nms(pushed, 0.0) - spin_Nms(coasts, 0.0));
        CHECK((turned - arm.cross(impulse_B)).norm() < 0.02 * arm.cross(impulse_B).norm());
    }
}

TEST_CASE("the vehicle's step is of fourth order without air, and hanging on its parachute",
          "[simulation][vehicle][convergence]") {
    const Vehicle tumbling = tumbling_above_the_air();
    CHECK(order(tumbling, 2.0, 12.8, 0.4, apart_rad) == Approx(4.0).margin(0.4));
    CHECK(order(tumbling, 2.0, 640.0, 80.0, apart_m) == Approx(4.0).margin(0.5));

    Vehicle hanging = vehicle_at(5950.0, {8.0, -5.0, -95.0});  // within one layer of the air's table
    hanging.fire(flight::PyroId::parachute_mortar, 0.0);
    hanging = flown(hanging, 10.0, 0.2, 0.005);
    CHECK(order(hanging, 10.2, 3.2, 0.64, apart_m) == Approx(4.0).margin(0.5));
    CHECK(order(hanging, 10.2, 3.2, 0.08, apart_rad) == Approx(4.0).margin(0.5));
}

TEST_CASE("while engines burn the step is of second order: thrust goes in a straight line over it, mass is its mean",
          "[simulation][vehicle][convergence]") {
    Vehicle vehicle = vehicle_at(1000.0, {0.0, 0.0, -80.0});
    vehicle.fire(flight::PyroId::engine_valves, 0.0);
    vehicle.fire(flight::PyroId::heatshield_separation, 0.0);
    vehicle.fire(flight::PyroId::backshell_separation, 0.0);
    flight::EngineCommand uneven;
    uneven.ignited = true;
    uneven.throttle = {0.6, 0.5, 0.55, 0.6, 0.5, 0.6, 0.55, 0.5};
    vehicle.command({}, false, uneven, false, 6.0);
    vehicle = flown(vehicle, 7.0, 1.0, 0.005);
    uneven.throttle = {0.7, 0.3, 0.5, 0.4, 0.6, 0.5, 0.4, 0.6};
    vehicle.command({}, false, uneven, false, 8.0);
    CHECK(order(vehicle, 8.0, 0.32, 0.02, apart_m) == Approx(2.0).margin(0.4));
    CHECK(order(vehicle, 8.0, 0.32, 0.02, apart_rad) == Approx(2.0).margin(0.4));
}

}  // namespace simulation_vehicle_step_test
