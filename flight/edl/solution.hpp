// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/edl_gnc.hpp"
#include "generated/dictionary_flight.hpp"

#include <numbers>
#include <optional>

namespace aeolis::flight {

using SolutionConditions = FixedVector<gnc::Condition, 16>;

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

/// The conditions under which GNC can fly from these parameters.
/// Each argument is already within its own range. Checked here: combinations of arguments, and their relation to `now`.
/// @param as_built  the table that the vehicle was loaded with
SolutionConditions conditions_of(const command::EDL_SET_PARAMETERS& p, Sclk now, const Parameters& as_built);

/// The entry to which the position and velocity of the parameters lead. R51
struct NavigatedEntry {
    Sclk at;                             ///< entry interface, close to `entry_sclk` if that is sound
    gnc::Vector3 p_MoB_M_m, v_MB_M_mps;  ///< at `entry_sclk`
};
/// The state is propagated to `entry_sclk`; the remaining height counts at the descent rate there. None where the
/// vehicle does not descend then.
std::optional<NavigatedEntry> navigated_entry(const command::EDL_SET_PARAMETERS& p);

/// The conditions under which range control can reach the target from there.
gnc::Conditions target_conditions(const command::EDL_SET_PARAMETERS& p, const NavigatedEntry& entry);

}  // namespace aeolis::flight
