#pragma once

#include "flight/gnc/edl_gnc.hpp"
#include "generated/dictionary_flight.hpp"

#include <numbers>

namespace aeolis::flight {

/// What EDL_SET_PARAMETERS says, as GNC takes it: angles in radians.
inline gnc::Solution solution_of(const command::EDL_SET_PARAMETERS& p) {
    constexpr double degree_rad = std::numbers::pi / 180.0;
    gnc::Solution solution;
    solution.epoch = Sclk{p.epoch_sclk};
    solution.p_MoB_M_m = {p.position_x_m, p.position_y_m, p.position_z_m};
    solution.v_MB_M_mps = {p.velocity_x_mps, p.velocity_y_mps, p.velocity_z_mps};
    solution.entry = Sclk{p.entry_sclk};
    solution.target_latitude_rad = p.target_latitude_deg * degree_rad;
    solution.target_longitude_rad = p.target_longitude_deg * degree_rad;
    solution.target_radius_m = p.target_radius_m;
    solution.parachute_speed_mps = p.parachute_speed_mps;
    solution.heatshield_speed_mps = p.heatshield_speed_mps;
    solution.backshell_altitude_m = p.backshell_altitude_m;
    return solution;
}

}  // namespace aeolis::flight
