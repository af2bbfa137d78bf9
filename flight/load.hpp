// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "generated/parameters.hpp"

#include <array>
#include <cstdint>
#include <optional>

// Values loaded into a flight computer before the first tick: mission design values that are not commands. The scenario
// sets them; ground's navigation solution arrives by EDL_SET_PARAMETERS.
namespace aeolis::flight {

/// Reference trajectory of entry guidance, by planet-relative velocity; rows ascend in velocity.
/// Generated from a scenario by simulation/entry_reference, never written by hand. [apollo-entry-guidance]
struct EntryReferenceRow {
    double velocity_mps = 0.0;
    double range_to_go_m = 0.0;
    double drag_mps2 = 0.0;
    double altitude_rate_mps = 0.0;
    double d_range_d_drag_s2 = 0.0;
    double d_range_d_altitude_rate_s = 0.0;
    double d_range_d_lift_to_drag_m = 0.0;
    double lift_to_drag = 0.0;  ///< vertical L/D flown on the reference
};
struct EntryReference {
    std::array<EntryReferenceRow, 64> rows{};
    std::uint32_t row_count = 0;
};

enum class Plan : std::uint8_t { mission, wideband };

/// Role in which a computer was started.
/// Ground designates prime by command before EDL; the other is its backup. R1
enum class Role : std::uint8_t { prime, second_chance };
/// One of the two computers, by its place in the vehicle.
enum class String : std::uint8_t { a, b };

struct Load {
    String string = String::a;
    Role role = Role::prime;
    /// After a restart: the last cycle whose state the other computer can have received.
    std::optional<Sclk> told_until;
    std::uint32_t resets = 0;  ///< so far
    // NOLINTBEGIN(readability-magic-numbers): the vehicle of 2012, unless a scenario gives its own
    double uhf_rate_bps = 8000.0;         ///< rate of the real-time link
    Plan telemetry_plan = Plan::mission;  ///< wideband: a synthetic load for benchmarks
    double entry_mass_kg = 3153.0;
    double entry_lift_to_drag = 0.24;
    double powered_descent_mass_kg = 2269.0;  ///< at backshell separation
    double descent_stage_dry_kg = 983.0;
    double rover_mass_kg = 899.0;
    double engine_max_thrust_N = 3603.0;  ///< one engine
    double engine_min_thrust_N = 31.0;
    double engine_isp_s = 210.0;
    double divert_m = 304.0;
    double divert_azimuth_deg = 112.0;
    double aim_east_m = 0.0, aim_north_m = 0.0;  ///< where entry guidance aims, from the target that ground sends
    double gravity_fraction = 0.0;  ///< by which gravity is taken for stronger near the ground than `gnc::gravity`
    // NOLINTEND(readability-magic-numbers)
    EntryReference entry_reference;
    Parameters parameters;  ///< until ground changes them; of this vehicle, each within its range
};

/// Shift of the navigation state for a campaign case, as if its errors had existed from the start.
/// Applied from outside; nothing on board requests it.
struct NavigationShift {
    std::array<double, 3> p_MoB_M_m{};
    std::array<double, 3> v_MB_M_mps{};
    std::array<double, 4> q_BB{1, 0, 0, 0};           ///< applied after the attitude, in B
    std::array<double, 3> accelerometer_bias_mps2{};  ///< in B: change of the bias learnt in vacuum
};

}  // namespace aeolis::flight
