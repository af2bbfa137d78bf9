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
    : gnc_(load), timeline_(solution.entry) {
    gnc_.set_solution(solution_of(solution), now);
}

void GncAlone::cycle(const flight::DeviceInputs& in, flight::DeviceOutputs& out) {
    out.begin_cycle();
    timeline_.act(in.now, out);
    gnc_.cycle(in, configuration(), told_);
    if (configuration().radar_on) {
        // As in flight: the beams meet the attitude of their own tick, and the solution waits for the next cycle.
        batch_.on(in.now, in.radar.span(), flight::gnc::to_quaternion(told_.q_MB),
                  flight::gnc::to_vector(told_.p_MoB_M_m).normalized());
        if (in.now.ticks() % 64 == 0)
            if (const auto solution = batch_.solve(in.now)) gnc_.on(*solution);
    }
    timeline_.take(told_, in.now);
    timeline_.act(in.now, out);
    out.thrusters = told_.thrusters;
    out.engines = told_.engines;
}

} // namespace aeolis::simulation
