// SPDX-License-Identifier: Apache-2.0
#include "flight/edl/solution.hpp"

#include "flight/gnc/entry/target_geometry.hpp"
#include "flight/gnc/mars.hpp"
#include "flight/gnc/powered_descent/vertical_profile.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace aeolis::flight {
namespace {

constexpr double clock_end_s = std::numeric_limits<std::uint32_t>::max();  // of the clock's whole seconds in packets

}  // namespace

SolutionConditions conditions_of(const command::EDL_SET_PARAMETERS& p, Sclk now, const Parameters& as_built) {
    const double radius_m = std::hypot(p.position_x_m, p.position_y_m, p.position_z_m);
    // Without what Mars's rotation adds at that distance.
    const double speed_mps = std::hypot(p.velocity_x_mps - gnc::mars_spin_rps * p.position_y_m,
                                        p.velocity_y_mps + gnc::mars_spin_rps * p.position_x_m, p.velocity_z_mps);
    const double to_entry_s = p.entry_sclk - now.seconds;
    SolutionConditions conditions;
    conditions.push_back(gnc::above(Quantity::time_to_uplinked_entry_s, to_entry_s, 0.0));
    conditions.push_back(gnc::at_most(Quantity::solution_age_s, std::abs(p.epoch_sclk - now.seconds),
                                      build_parameters.solution_age_max_s));
    conditions.push_back(gnc::at_least(Quantity::solution_radius_m, radius_m, build_parameters.solution_radius_min_m));
    conditions.push_back(gnc::at_most(Quantity::solution_radius_m, radius_m, build_parameters.solution_radius_max_m));
    conditions.push_back(
        gnc::at_most(Quantity::solution_speed_mps, speed_mps, build_parameters.solution_speed_max_mps));
    conditions.push_back(gnc::at_least(Quantity::epoch_before_entry_s, p.entry_sclk - p.epoch_sclk, 0.0));
    conditions.push_back(gnc::at_most(Quantity::time_to_uplinked_entry_s, to_entry_s, clock_end_s - now.seconds));
    // Backshell altitude and speed belong together: from there on, the powered approach needs its height.
    const double ends_m = p.backshell_altitude_m - gnc::powered_descent::altitude_used_until_constant_velocity_m(
                                                       as_built, p.backshell_speed_mps);
    conditions.push_back(
        gnc::at_least(Quantity::approach_end_by_design_m, ends_m, build_parameters.approach_end_by_design_min_m));
    conditions.push_back(
        gnc::at_most(Quantity::approach_end_by_design_m, ends_m, build_parameters.approach_end_by_design_max_m));
    return conditions;
}

std::optional<NavigatedEntry> navigated_entry(const command::EDL_SET_PARAMETERS& sent) {
    gnc::Vector3 p_MoB_M{sent.position_x_m, sent.position_y_m, sent.position_z_m};
    gnc::Vector3 v_MB_M{sent.velocity_x_mps, sent.velocity_y_mps, sent.velocity_z_mps};
    double left_s = sent.entry_sclk - sent.epoch_sclk;
    for (int step = 0; left_s > 0.0; ++step) {
        const double radius_m = p_MoB_M.norm();
        const double falls_in_s = std::sqrt(radius_m * radius_m * radius_m / gnc::mars_gm_m3ps2);
        const double dt_s =
            std::min(left_s, build_parameters.entry_step_fraction * std::min(falls_in_s, radius_m / v_MB_M.norm()));
        if (step >= build_parameters.entry_steps_max || !(dt_s > 0.0)) return {};
        gnc::fall(p_MoB_M, v_MB_M, dt_s);
        left_s -= dt_s;
    }
    const double radius_m = p_MoB_M.norm();
    const double descent_rate_mps = -v_MB_M.dot(p_MoB_M) / radius_m;
    if (!(descent_rate_mps > 0.0)) return {};
    return NavigatedEntry{Sclk{sent.entry_sclk} + (radius_m - build_parameters.entry_radius_m) / descent_rate_mps,
                          p_MoB_M, v_MB_M};
}

gnc::Conditions target_conditions(const command::EDL_SET_PARAMETERS& p, const NavigatedEntry& entry) {
    const gnc::Solution solution = solution_of(p);
    const auto target = gnc::target_geometry(
        entry.p_MoB_M_m, entry.v_MB_M_mps,
        gnc::direction_of(solution.target_latitude_rad, solution.target_longitude_rad), solution.target_radius_m);
    gnc::Conditions conditions;
    conditions.push_back(
        gnc::at_least(Quantity::target_downrange_m, target.downrange_m, build_parameters.target_downrange_min_m));
    conditions.push_back(
        gnc::at_most(Quantity::target_downrange_m, target.downrange_m, build_parameters.target_downrange_max_m));
    conditions.push_back(
        gnc::at_most(Quantity::crossrange_m, std::abs(target.crossrange_m), build_parameters.target_crossrange_max_m));
    return conditions;
}

}  // namespace aeolis::flight
