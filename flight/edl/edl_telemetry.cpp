// SPDX-License-Identifier: Apache-2.0
#include "flight/edl/edl_main.hpp"

#include "flight/gnc/mars.hpp"

#include <cmath>
#include <numbers>

// Channels that EdlMain records, and their rates. EdlComm's plan selects those sent to ground.
namespace aeolis::flight {
namespace {

constexpr double degrees_per_radian = 180.0 / std::numbers::pi;
using gnc::standard_gravity_mps2;
constexpr double parts_in_percent = 100.0;

/// Whether a packet of `hz` (a power of two up to 64) is due in this cycle.
bool due(Sclk now, std::int64_t hz) {
    return at_resolution(now, hz) == now;
}

std::optional<double> seconds(MaybeTime time) {
    if (!time.defined()) return std::nullopt;
    return time.get()->seconds;
}

packet::GncNavigation navigation(const gnc::Output& gnc) {
    return {.nav_position_x_m = gnc.p_MoB_M_m[0],
            .nav_position_y_m = gnc.p_MoB_M_m[1],
            .nav_position_z_m = gnc.p_MoB_M_m[2],
            .nav_velocity_x_mps = single(gnc.v_MB_M_mps[0]),
            .nav_velocity_y_mps = single(gnc.v_MB_M_mps[1]),
            .nav_velocity_z_mps = single(gnc.v_MB_M_mps[2]),
            .altitude_m = single(gnc.altitude_m),
            .speed_mps = single(gnc.speed_mps),
            .descent_rate_mps = single(gnc.descent_rate_mps),
            .flight_path_deg = single(gnc.flight_path_deg),
            .horizontal_speed_mps = single(gnc.horizontal_speed_mps),
            .bank_deg = single(gnc.bank_deg),
            .angle_of_attack_deg = single(gnc.angle_of_attack_deg),
            .nav_attitude_w = single(gnc.q_MB[0]),
            .nav_attitude_x = single(gnc.q_MB[1]),
            .nav_attitude_y = single(gnc.q_MB[2]),
            .nav_attitude_z = single(gnc.q_MB[3])};
}

packet::GncEntry entry_guidance(const gnc::Output& gnc) {
    return {.drag_mps2 = single(gnc.drag_mps2),
            .range_to_go_m = single(gnc.range_to_go_m),
            .crossrange_m = single(gnc.crossrange_m),
            .bank_command_deg = single(gnc.bank_command_deg),
            .predicted_range_m = single(gnc.predicted_range_m),
            .lift_to_drag_command = single(gnc.lift_to_drag_command),
            .reversal_count = gnc.reversals,
            .dynamic_pressure_Pa = single(gnc.dynamic_pressure_Pa),
            .mach = single(gnc.mach)};
}

packet::GncImu imu(const gnc::Output& gnc) {
    const auto& a = gnc.acceleration_B_mps2;
    const auto& w = gnc.rate_B_rps;
    return {.acceleration_x_mps2 = single(a[0]),
            .acceleration_y_mps2 = single(a[1]),
            .acceleration_z_mps2 = single(a[2]),
            .sensed_deceleration_g = single(std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) / standard_gravity_mps2),
            .rate_x_dps = single(w[0] * degrees_per_radian),
            .rate_y_dps = single(w[1] * degrees_per_radian),
            .rate_z_dps = single(w[2] * degrees_per_radian)};
}

packet::GncDescent descent(const gnc::Output& gnc, double bridle_m, const EngineReply& reply) {
    const auto& throttle = gnc.engines.throttle;
    double sum = 0.0;
    for (const double one : throttle) sum += one;
    const auto percent = [&](std::size_t engine) { return single(throttle[engine] * parts_in_percent); };
    return {.descent_mode = static_cast<GncMode>(gnc.mode),
            .thrust_command_N = single(gnc.thrust_command_N),
            .throttle_mean_percent = single(sum / static_cast<double>(throttle.size()) * parts_in_percent),
            // NOLINTBEGIN(readability-magic-numbers): the engines, by number
            .throttle_1_percent = percent(0),
            .throttle_2_percent = percent(1),
            .throttle_3_percent = percent(2),
            .throttle_4_percent = percent(3),
            .throttle_5_percent = percent(4),
            .throttle_6_percent = percent(5),
            .throttle_7_percent = percent(6),
            .throttle_8_percent = percent(7),
            // NOLINTEND(readability-magic-numbers)
            .mass_estimate_kg = single(gnc.mass_kg),
            .propellant_kg = single(gnc.propellant_kg),
            .bridle_m = single(bridle_m),
            .engine_thrust_N = single(reply.thrust_N),
            .engines_running = reply.running};
}

packet::GncConfiguration flown_as(const gnc::Configuration& c) {
    return {.gnc_enabled = c.enabled,
            .pyros_armed = c.pyros_armed,
            .cruise_stage_gone = c.cruise_stage_gone,
            .turning_to_entry = c.turning_to_entry,
            .guidance_armed = c.guidance_armed,
            .sufr_allowed = c.sufr_allowed,
            .parachute_out = c.parachute_out,
            .heatshield_gone = c.heatshield_gone,
            .radar_processing = c.radar_on,
            .engines_primed = c.engines_primed,
            .backshell_gone = c.backshell_gone,
            .engines_ignited = c.engines_ignited,
            .sky_crane_started = c.sky_crane_started,
            .rover_separated = c.rover_separated,
            .touchdown_logic_ready = c.touchdown_logic_ready,
            .touchdown_declared = c.touchdown_declared,
            .bridle_gone = c.bridle_cut,
            .flyaway_started = c.flyaway_started,
            .engines_off = c.engines_off};
}

packet::GncBelief belief(const gnc::Output& gnc) {
    return {.dead_reckoned_s = single(gnc.dead_reckoned_s),
            .attitude_uncertainty_deg = single(gnc.attitude_uncertainty_deg),
            .velocity_uncertainty_mps = single(gnc.velocity_uncertainty_mps),
            .altitude_uncertainty_m = single(gnc.altitude_uncertainty_m),
            .propellant_low = gnc.propellant_low};
}

// NOLINTBEGIN(readability-magic-numbers): the names of the thirty channels
/// Synthetic load for benchmarks: thirty slow waves of known phase, no quantities of the vehicle.
packet::Wideband wideband(Sclk now) {
    const auto wave = [&](int channel) {
        return single(std::sin(0.1 * channel * std::remainder(now.seconds, 20.0 * std::numbers::pi / channel)));
    };
    return {.wideband_01 = wave(1),
            .wideband_02 = wave(2),
            .wideband_03 = wave(3),
            .wideband_04 = wave(4),
            .wideband_05 = wave(5),
            .wideband_06 = wave(6),
            .wideband_07 = wave(7),
            .wideband_08 = wave(8),
            .wideband_09 = wave(9),
            .wideband_10 = wave(10),
            .wideband_11 = wave(11),
            .wideband_12 = wave(12),
            .wideband_13 = wave(13),
            .wideband_14 = wave(14),
            .wideband_15 = wave(15),
            .wideband_16 = wave(16),
            .wideband_17 = wave(17),
            .wideband_18 = wave(18),
            .wideband_19 = wave(19),
            .wideband_20 = wave(20),
            .wideband_21 = wave(21),
            .wideband_22 = wave(22),
            .wideband_23 = wave(23),
            .wideband_24 = wave(24),
            .wideband_25 = wave(25),
            .wideband_26 = wave(26),
            .wideband_27 = wave(27),
            .wideband_28 = wave(28),
            .wideband_29 = wave(29),
            .wideband_30 = wave(30)};
}
// NOLINTEND(readability-magic-numbers)

}  // namespace

void EdlMain::record_channels(Sclk now, Outbox& out) {
    if (due(now, 1)) {
        out.record(packet::EdlStatus{.edl_phase = phase(),
                                     .edl_enabled = timeline_.begun(),
                                     .parameters_received = parameters_.has_value(),
                                     .late_cruise = late_cruise(now),
                                     .seconds_to_entry_s =
                                         entry().defined() ? std::optional{*entry().get() - now} : std::nullopt,
                                     .edl_cycle_count = cycle_count_,
                                     .reset_count = reset_count(),
                                     .fault_inhibit = inhibited_,
                                     .computer_role = static_cast<ComputerRole>(load_.role)});
        out.record(packet::TimelineStatus{.timeline_version = timeline_version,
                                          .timepoint_index = timeline_.current().value,
                                          .timepoint_state = timeline_.state(),
                                          .next_desired_sclk = seconds(timeline_.next_desired()),
                                          .next_minimum_sclk = seconds(timeline_.next_minimum()),
                                          .entry_anchor_sclk = seconds(entry()),
                                          .parachute_anchor_sclk = seconds(timeline_.anchor_time(anchor::parachute)),
                                          .backshell_anchor_sclk = seconds(timeline_.anchor_time(anchor::backshell)),
                                          .touchdown_anchor_sclk = seconds(timeline_.anchor_time(anchor::touchdown))});
    }
    // Repeated while parameters may still arrive, so that a lost or early read-back is made up for.
    const auto held_every_s = static_cast<std::int64_t>(table_.values().parameters_held_every_s);
    if (!configuration_.enabled && due(now, 1) && now.ticks() / 64 % held_every_s == 0) {
        if (parameters_) out.record(parameters_held());
        out.record(table_.report());
    }
    if (load_.telemetry_plan == Plan::wideband) out.record(wideband(now));
    // Before "do edl" too: ground asks it before parameters leave.
    if (const auto is = flown_as(configuration_); due(now, 1) || is != recorded_configuration_) {
        out.record(is);
        recorded_configuration_ = is;
    }
    if (!configuration_.enabled) return;

    const bool in_atmosphere = phase() >= EdlPhase::wait_for_guidance;
    if (due(now, in_atmosphere ? 64 : 8)) out.record(navigation(output_));
    if (due(now, in_atmosphere ? 16 : 8)) out.record(imu(output_));
    if (due(now, 1)) out.record(belief(output_));
    if (in_atmosphere && phase() < EdlPhase::parachute_descent && due(now, 8)) out.record(entry_guidance(output_));
    if (phase() >= EdlPhase::powered_descent && phase() != EdlPhase::landed)
        out.record(descent(output_, bridle_m_, engines_));
}

packet::ParametersHeld EdlMain::parameters_held() const {
    if (!parameters_) return {};
    const auto& p = *parameters_;
    return {.solution_id = p.solution_id,
            .epoch_sclk = p.epoch_sclk,
            .position_x_m = p.position_x_m,
            .position_y_m = p.position_y_m,
            .position_z_m = p.position_z_m,
            .velocity_x_mps = p.velocity_x_mps,
            .velocity_y_mps = p.velocity_y_mps,
            .velocity_z_mps = p.velocity_z_mps,
            .entry_sclk = p.entry_sclk,
            .target_latitude_deg = p.target_latitude_deg,
            .target_longitude_deg = p.target_longitude_deg,
            .target_radius_m = p.target_radius_m,
            .parachute_speed_mps = p.parachute_speed_mps,
            .parachute_altitude_min_m = p.parachute_altitude_min_m,
            .heatshield_speed_mps = p.heatshield_speed_mps,
            .backshell_altitude_m = p.backshell_altitude_m,
            .backshell_speed_mps = p.backshell_speed_mps};
}

}  // namespace aeolis::flight
