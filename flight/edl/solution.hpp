// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/edl_gnc.hpp"
#include "generated/dictionary_flight.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace aeolis::flight {

/// Converts the arguments of EDL_SET_PARAMETERS to GNC's form: angles in radians.
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
    solution.parachute_altitude_min_m = p.parachute_altitude_min_m;
    solution.heatshield_speed_mps = p.heatshield_speed_mps;
    solution.backshell_altitude_m = p.backshell_altitude_m;
    solution.backshell_descent_rate_mps = p.backshell_speed_mps;
    return solution;
}

/// Whether GNC can fly from these parameters.
/// Each argument is already within its own range. Checked here: combinations of arguments, and their relation to `now`.
inline bool possible(const command::EDL_SET_PARAMETERS& p, Sclk now) {
    const double radius_m = std::hypot(p.position_x_m, p.position_y_m, p.position_z_m);
    const double speed_mps = std::hypot(p.velocity_x_mps, p.velocity_y_mps, p.velocity_z_mps);
    return radius_m >= parameters.solution_radius_min_m && radius_m <= parameters.solution_radius_max_m &&
           speed_mps <= parameters.solution_speed_max_mps && p.entry_sclk > now.seconds &&
           p.entry_sclk <= std::numeric_limits<std::uint32_t>::max() && p.epoch_sclk <= p.entry_sclk &&
           std::abs(p.epoch_sclk - now.seconds) <= parameters.solution_age_max_s;
}

/// The time at which the position and velocity reach entry interface, close to `entry_sclk` if that is sound. R51
/// The state is propagated to `entry_sclk`; the remaining height counts at the descent rate there. Undefined where the
/// vehicle does not descend then.
MaybeTime navigated_entry(const command::EDL_SET_PARAMETERS& p);

}  // namespace aeolis::flight
