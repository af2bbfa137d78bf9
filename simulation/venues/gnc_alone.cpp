// SPDX-License-Identifier: Apache-2.0
#include "simulation/venues/gnc_alone.hpp"

#include "flight/gnc/mars.hpp"

namespace aeolis::simulation {

flight::gnc::Solution solution_of(const NavigationSolution& from) {
    flight::gnc::Solution solution;
    solution.epoch = from.epoch;
    solution.p_MoB_M_m = from.p_MoB_M_m;
    solution.v_MB_M_mps = from.v_MB_M_mps;
    solution.entry = from.entry;
    solution.target_latitude_rad = from.target.latitude_deg * flight::gnc::degree;
    solution.target_longitude_rad = from.target.longitude_deg * flight::gnc::degree;
    solution.target_radius_m = from.target.radius_m;
    solution.parachute_speed_mps = from.parachute_speed_mps;
    solution.heatshield_speed_mps = from.heatshield_speed_mps;
    solution.backshell_altitude_m = from.backshell_altitude_m;
    return solution;
}

GncAlone::GncAlone(const flight::Load& load, const NavigationSolution& solution, Sclk now)
    : parameters_(load.parameters), gnc_(load), timeline_(solution.entry) {
    gnc_.set_solution(solution_of(solution), now);
}

const flight::DeviceOutputs& GncAlone::cycle(const flight::DeviceInputs& in) {
    out_.begin_cycle();
    timeline_.act(in.now, out_);
    gnc_.cycle(in, configuration(), told_);
    if (configuration().radar_on) {
        // As in flight: the beams are combined with the attitude of their own tick, and the solution waits for the next
        // cycle.
        batch_.on(parameters_, in.now, in.radar.span(), flight::gnc::to_quaternion(told_.q_MB),
                  flight::gnc::to_vector(told_.p_MoB_M_m).normalized());
        if (in.now.ticks() % 64 == 0)
            if (const auto solution = batch_.solve(parameters_, in.now)) gnc_.on(*solution);
    }
    timeline_.take(told_, in.now);
    timeline_.act(in.now, out_);
    out_.thrusters = told_.thrusters;
    out_.engines = told_.engines;
    return out_;
}

const char* decided_by_gnc(flight::gnc::Trigger trigger) {
    using flight::gnc::Trigger;
    switch (trigger) {
    case Trigger::guidance_start: return "guidance_start";
    case Trigger::heading_alignment: return "heading_alignment";
    case Trigger::radar_lock: return "radar_lock";
    case Trigger::powered_approach: return "powered_approach_start";
    case Trigger::constant_velocity: return "constant_velocity_start";
    case Trigger::constant_deceleration: return "constant_deceleration_start";
    case Trigger::touchdown: return "touchdown";
    default: return nullptr;
    }
}

}  // namespace aeolis::simulation
