// SPDX-License-Identifier: Apache-2.0
#include "simulation/initial_state.hpp"

#include "simulation/entry_flight.hpp"
#include "simulation/mars/earth.hpp"
#include "simulation/random.hpp"

namespace aeolis::simulation {
namespace {

PointMass delivered(const Scenario& scenario, Random random, std::vector<Draw>& draws) {
    PointMass at = nominal_entry(scenario);
    const Horizon nominal = horizon(at.p_MoB_M);
    const double axis_m = scenario.dispersions.delivery_position_m / std::numbers::sqrt2;
    const double east_m = axis_m * random.normal();
    const double north_m = axis_m * random.normal();
    at.p_MoB_M = (at.p_MoB_M + east_m * nominal.east + north_m * nominal.north).normalized() * scenario.entry.radius_m;
    const Horizon local = horizon(at.p_MoB_M);
    const double turn_rad = scenario.dispersions.delivery_flight_path_deg * degree_rad * random.normal();
    draws = {{"delivery_east_m", east_m},
             {"delivery_north_m", north_m},
             {"delivery_flight_path_deg", turn_rad / degree_rad}};
    const Vector3 sideways = at.v_MB_M.cross(local.up).normalized();
    at.v_MB_M = Eigen::AngleAxisd(turn_rad, sideways) * at.v_MB_M;
    return at;
}

/// Seconds until a vehicle at `at` passes the entry radius; first order is enough for a kilometre.
double entry_delay_s(const PointMass& at, double entry_radius_m) {
    const Vector3 up = at.p_MoB_M.normalized();
    return (entry_radius_m - at.p_MoB_M.norm()) / at.v_MB_M.dot(up);
}

double to_tick(double seconds) {
    return std::round(seconds * 64.0) / 64.0;
}

}  // namespace

Quaternion cruise_attitude(double before_entry_s) {
    return Quaternion::FromTwoVectors(Vector3::UnitZ(), -earth_direction_M(-before_entry_s));
}

InitialState initial_state(const Scenario& scenario, std::uint64_t seed, std::uint64_t case_number) {
    return state_before_entry(scenario, to_tick(scenario.start_before_entry_s), seed, case_number);
}

InitialState state_before_entry(const Scenario& scenario, double before_entry_s, std::uint64_t seed,
                                std::uint64_t case_number) {
    InitialState initial;
    const PointMass entry = delivered(scenario, Random{seed, case_number, Stream::delivery}, initial.draws);
    initial.start = scenario.entry_sclk - before_entry_s;
    initial.truth = coast(entry, -before_entry_s);

    Random knowledge{seed, case_number, Stream::knowledge};
    const double by_axis = 1.0 / std::numbers::sqrt3;
    PointMass believed = entry;
    believed.p_MoB_M += scenario.dispersions.knowledge_position_m * by_axis * vector3(knowledge.normal3());
    believed.v_MB_M += scenario.dispersions.knowledge_velocity_mps * by_axis * vector3(knowledge.normal3());
    if (scenario.believed) {
        const Horizon local = horizon(entry.p_MoB_M);
        believed.p_MoB_M += scenario.believed->position_east_m * local.east +
                            scenario.believed->position_north_m * local.north +
                            scenario.believed->position_up_m * local.up;
    }
    add_axes(initial.draws, "knowledge_position", "m", believed.p_MoB_M - entry.p_MoB_M);
    add_axes(initial.draws, "knowledge_velocity", "mps", believed.v_MB_M - entry.v_MB_M);
    const PointMass at_start = coast(believed, -before_entry_s);

    NavigationSolution& solution = initial.solution;
    solution.epoch = initial.start;
    solution.p_MoB_M_m = array3(at_start.p_MoB_M);
    solution.v_MB_M_mps = array3(at_start.v_MB_M);
    solution.entry = scenario.entry_sclk + to_tick(entry_delay_s(believed, scenario.entry.radius_m));
    solution.target = scenario.target;
    solution.parachute_speed_mps = scenario.parachute_speed_mps;
    solution.heatshield_speed_mps = scenario.heatshield_speed_mps;
    solution.backshell_altitude_m = scenario.backshell_altitude_m;
    return initial;
}

}  // namespace aeolis::simulation
