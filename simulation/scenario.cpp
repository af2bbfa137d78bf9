// SPDX-License-Identifier: Apache-2.0
#include "simulation/scenario.hpp"

#include "simulation/mars/mars.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace aeolis::simulation {
namespace {

struct Bounded {
    const char* name;
    double value, least, most;
};

std::string number(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.10g", value);
    return text.data();
}

/// Bounds of the fields. Our assumption: wide enough for any landing on Mars that the models cover, narrow enough to
/// catch a slip.
std::vector<Bounded> bounded_fields(const Scenario& s) {
    return {
        {"entry_sclk", s.entry_sclk.seconds, 1.0e6, 4.2e9},
        {"start_before_entry_s", s.start_before_entry_s, 60.0, 864000.0},
        {"end_after_touchdown_s", s.end_after_touchdown_s, 0.0, 3600.0},
        {"timeout_after_entry_s", s.timeout_after_entry_s, 60.0, 7200.0},
        {"entry.radius_m", s.entry.radius_m, 3.45e6, 3.6e6},
        {"entry.latitude_deg", s.entry.latitude_deg, -89.0, 89.0},
        {"entry.longitude_deg", s.entry.longitude_deg, -180.0, 360.0},
        {"entry.speed_mps", s.entry.speed_mps, 1000.0, 20000.0},
        {"entry.flight_path_deg", s.entry.flight_path_deg, -89.0, -1.0},
        {"entry.azimuth_deg", s.entry.azimuth_deg, -180.0, 360.0},
        {"target.latitude_deg", s.target.latitude_deg, -89.0, 89.0},
        {"target.longitude_deg", s.target.longitude_deg, -180.0, 360.0},
        {"target.radius_m", s.target.radius_m, 3.37e6, 3.42e6},
        {"target.ellipse_major_m", s.target.ellipse_major_m, 0.0, 300000.0},
        {"target.ellipse_minor_m", s.target.ellipse_minor_m, s.target.ellipse_major_m > 0.0 ? 1.0 : 0.0,
         s.target.ellipse_major_m},
        {"masses.cruise_stage_kg", s.masses.cruise_stage_kg, 0.0, 5000.0},
        {"masses.cruise_balance_each_kg", s.masses.cruise_balance_each_kg, 0.0, 500.0},
        {"masses.entry_kg", s.masses.entry_kg, 100.0, 10000.0},
        {"masses.entry_balance_each_kg", s.masses.entry_balance_each_kg, 0.0, 200.0},
        {"masses.heatshield_kg", s.masses.heatshield_kg, 0.0, 2000.0},
        {"masses.backshell_and_parachute_kg", s.masses.backshell_and_parachute_kg, 0.0, 2000.0},
        {"masses.powered_descent_kg", s.masses.powered_descent_kg, 100.0, 8000.0},
        {"masses.propellant_kg", s.masses.propellant_kg, 0.0, 4000.0},
        {"masses.rover_kg", s.masses.rover_kg, 1.0, 4000.0},
        {"gyration.with_cruise_stage_across_m", s.gyration.with_cruise_stage_across_m, 0.1, 5.0},
        {"gyration.with_cruise_stage_along_m", s.gyration.with_cruise_stage_along_m, 0.1, 5.0},
        {"gyration.entry_vehicle_across_m", s.gyration.entry_vehicle_across_m, 0.1, 5.0},
        {"gyration.entry_vehicle_along_m", s.gyration.entry_vehicle_along_m, 0.1, 5.0},
        {"gyration.without_heatshield_across_m", s.gyration.without_heatshield_across_m, 0.1, 5.0},
        {"gyration.without_heatshield_along_m", s.gyration.without_heatshield_along_m, 0.1, 5.0},
        {"gyration.stage_with_rover_across_m", s.gyration.stage_with_rover_across_m, 0.1, 5.0},
        {"gyration.stage_with_rover_along_m", s.gyration.stage_with_rover_along_m, 0.1, 5.0},
        {"gyration.stage_across_m", s.gyration.stage_across_m, 0.1, 5.0},
        {"gyration.stage_along_m", s.gyration.stage_along_m, 0.1, 5.0},
        {"stations.rover_m", s.stations.rover_m, -5.0, 5.0},
        {"stations.heatshield_m", s.stations.heatshield_m, -5.0, 5.0},
        {"stations.backshell_m", s.stations.backshell_m, -5.0, 5.0},
        {"stations.cruise_stage_m", s.stations.cruise_stage_m, -5.0, 5.0},
        {"stations.balances_m", s.stations.balances_m, -5.0, 5.0},
        {"stations.balances_off_axis_m", s.stations.balances_off_axis_m, 0.0, 5.0},
        {"dispersions.delivery_flight_path_deg", s.dispersions.delivery_flight_path_deg, 0.0, 2.0},
        {"dispersions.delivery_position_m", s.dispersions.delivery_position_m, 0.0, 100000.0},
        {"dispersions.knowledge_position_m", s.dispersions.knowledge_position_m, 0.0, 100000.0},
        {"dispersions.knowledge_velocity_mps", s.dispersions.knowledge_velocity_mps, 0.0, 100.0},
        {"dispersions.density_fraction", s.dispersions.density_fraction, 0.0, 0.5},
        {"dispersions.drag_fraction", s.dispersions.drag_fraction, 0.0, 0.3},
        {"dispersions.parachute_drag_fraction", s.dispersions.parachute_drag_fraction, 0.0, 0.3},
        {"dispersions.wind_mps", s.dispersions.wind_mps, 0.0, 50.0},
        {"dispersions.imu_bias_mps2", s.dispersions.imu_bias_mps2, 0.0, 0.1},
        {"dispersions.gyro_bias_rps", s.dispersions.gyro_bias_rps, 0.0, 1.0e-3},
        {"dispersions.attitude_rad", s.dispersions.attitude_rad, 0.0, 0.2},
        {"dispersions.radar_range_fraction", s.dispersions.radar_range_fraction, 0.0, 0.2},
        {"dispersions.radar_velocity_mps", s.dispersions.radar_velocity_mps, 0.0, 5.0},
        {"dispersions.imu_misalignment_rad", s.dispersions.imu_misalignment_rad, 0.0, 0.1},
        {"dispersions.gust_mps", s.dispersions.gust_mps, 0.0, 30.0},
        {"dispersions.radar_dropout_fraction", s.dispersions.radar_dropout_fraction, 0.0, 1.0},
        {"dispersions.terrain_height_m", s.dispersions.terrain_height_m, 0.0, 500.0},
        {"dispersions.terrain_slope_deg", s.dispersions.terrain_slope_deg, 0.0, 5.0},
        {"dispersions.parachute_plane_deg", s.dispersions.parachute_plane_deg, 0.0, 180.0},
        {"dispersions.mass_fraction", s.dispersions.mass_fraction, 0.0, 0.05},
        {"dispersions.slow_drag_fraction", s.dispersions.slow_drag_fraction, 0.0, 0.3},
        {"dispersions.imu_scale_fraction", s.dispersions.imu_scale_fraction, 0.0, 0.01},
        {"dispersions.gyro_scale_fraction", s.dispersions.gyro_scale_fraction, 0.0, 0.01},
        {"dispersions.imu_noise_mps", s.dispersions.imu_noise_mps, 0.0, 0.01},
        {"dispersions.gyro_noise_rad", s.dispersions.gyro_noise_rad, 0.0, 0.001},
        {"dispersions.density_aloft_fraction", s.dispersions.density_aloft_fraction, 0.0, 0.5},
        {"dispersions.parachute_oscillation_fraction", s.dispersions.parachute_oscillation_fraction, 0.0, 0.5},
        {"dispersions.radar_sand_mps", s.dispersions.radar_sand_mps, 0.0, 10.0},
        {"dispersions.terrain_roughness_m", s.dispersions.terrain_roughness_m, 0.0,
         std::min(50.0, 0.2 * s.ground.roughness_length_m)},
        {"limits.propellant_left_min_kg", s.limits.propellant_left_min_kg, 0.0, 4000.0},
        {"limits.touchdown_vertical_max_mps", s.limits.touchdown_vertical_max_mps, 0.0, 10.0},
        {"limits.touchdown_horizontal_max_mps", s.limits.touchdown_horizontal_max_mps, 0.0, 10.0},
        {"limits.touchdown_tilt_max_deg", s.limits.touchdown_tilt_max_deg, 0.0, 180.0},
        {"limits.recontact_min_m", s.limits.recontact_min_m, 0.0, 1000.0},
        {"limits.parachute_mach_max", s.limits.parachute_mach_max, 0.0, 5.0},
        {"limits.parachute_pressure_max_Pa", s.limits.parachute_pressure_max_Pa, 0.0, 5000.0},
        {"limits.timeline_margin_min_s", s.limits.timeline_margin_min_s, 0.0, 60.0},
        {"limits.campaign_within_min_fraction", s.limits.campaign_within_min_fraction, 0.0, 1.0},
        {"ground.height_m", s.ground.height_m, -1000.0, 1000.0},
        {"ground.slope_deg", s.ground.slope_deg, 0.0, 20.0},
        {"ground.uphill_azimuth_deg", s.ground.uphill_azimuth_deg, -180.0, 360.0},
        {"ground.roughness_length_m", s.ground.roughness_length_m, 5.0, 5000.0},
        {"parachute_drag_area_m2", s.parachute_drag_area_m2, 1.0, 1000.0},
        {"parachute_lift_to_drag", s.parachute_lift_to_drag, 0.0, 1.0},
        {"wrist_damping_Nms", s.wrist_damping_Nms, 0.0, 20000.0},
        {"engines.largest_thrust_N", s.engines.largest_thrust_N, 100.0, 50000.0},
        {"engines.least_thrust_N", s.engines.least_thrust_N, 0.0, 0.9 * s.engines.largest_thrust_N},
        {"engines.least_impulse_s", s.engines.least_impulse_s, 50.0, 500.0},
        {"engines.most_impulse_s", s.engines.most_impulse_s, s.engines.least_impulse_s, 500.0},
        {"guidance.divert_m", s.guidance.divert_m, 0.0, 2000.0},
        {"guidance.divert_azimuth_deg", s.guidance.divert_azimuth_deg, -180.0, 360.0},
        {"guidance.entry_lift_to_drag", s.guidance.entry_lift_to_drag, 0.01, 1.0},
        {"guidance.engine_impulse_s", s.guidance.engine_impulse_s, 50.0, 500.0},
        {"guidance.aim_east_m", s.guidance.aim_east_m, -aim_max_m, aim_max_m},
        {"guidance.aim_north_m", s.guidance.aim_north_m, -aim_max_m, aim_max_m},
        {"guidance.reference_turn_mps", s.guidance.reference_turn_mps, 100.0, 20000.0},
        {"guidance.reference_held_from_mps", s.guidance.reference_held_from_mps, 100.0, 20000.0},
        {"guidance.reference_held_to_mps", s.guidance.reference_held_to_mps, 100.0, 20000.0},
        {"guidance.reference_up_mps", s.guidance.reference_up_mps, 100.0, 20000.0},
        {"guidance.reference_end_mps", s.guidance.reference_end_mps, 0.0, 500.0},
        {"steady_wind_east_mps", s.steady_wind_east_mps, -100.0, 100.0},
        {"steady_wind_north_mps", s.steady_wind_north_mps, -100.0, 100.0},
        {"radio.light_time_s", s.radio.light_time_s, 0.0, 1500.0},
        {"radio.uhf_rate_bps", s.radio.uhf_rate_bps, 1000.0, 1.0e7},
        {"radio.blackout_start_speed_mps", s.radio.blackout_start_speed_mps, 0.0, 20000.0},
        {"radio.blackout_end_speed_mps", s.radio.blackout_end_speed_mps, 0.0, 20000.0},
        {"radio.blackout_start_altitude_m", s.radio.blackout_start_altitude_m, 0.0, 200000.0},
        {"radio.uhf_loss_fraction", s.radio.uhf_loss_fraction, 0.0, 0.9},
        {"radio.uhf_burst_s", s.radio.uhf_burst_s, 0.001, 60.0},
        {"radio.uhf_loss_range_km", s.radio.uhf_loss_range_km, 1.0, 100000.0},
        {"radio.uhf_hand_over_s", s.radio.uhf_hand_over_s, 0.0, 60.0},
        {"radio.uplink_loss_fraction", s.radio.uplink_loss_fraction, 0.0, 0.9},
        {"radio.x_band_c_n0_dbhz", s.radio.x_band_c_n0_dbhz, -20.0, 60.0},
        {"radio.earth_set_after_entry_s", s.radio.earth_set_after_entry_s.value_or(0.0), -86400.0, 86400.0},
        {"radio.relay_rate_bps", s.radio.relay_rate_bps, 1000.0, 1.0e8},
        {"radio.relay_start_after_touchdown_s", s.radio.relay_start_after_touchdown_s, 0.0, 86400.0},
        {"bus_message_error_fraction", s.bus_message_error_fraction, 0.0, 0.5},
        {"triggers.parachute_speed_mps", s.parachute_speed_mps, 100.0, 1000.0},
        {"triggers.heatshield_speed_mps", s.heatshield_speed_mps, 20.0, 500.0},
        {"triggers.backshell_altitude_m", s.backshell_altitude_m, 100.0, 10000.0},
    };
}

void check_list_sizes(const Scenario& s, std::vector<std::string>& found) {
    const auto at_most = [&](std::size_t most, const std::string& list, std::size_t rows) {
        if (rows > most)
            found.push_back(list + ": has " + std::to_string(rows) + " rows, more than the " + std::to_string(most) +
                            " that are taken");
    };
    at_most(scenario_passes_max, "radio.relay_passes", s.radio.relay_passes.size());
    at_most(scenario_passes_max, "radio.tracking_passes", s.radio.tracking_passes.size());
    at_most(scenario_rows_max, "radio.tone_outages", s.radio.tone_outages.size());
    at_most(scenario_rows_max, "radio.delivery_restarts_after_touchdown_s",
            s.radio.delivery_restarts_after_touchdown_s.size());
    at_most(scenario_rows_max, "density_scale", s.density_scale.size());
    at_most(scenario_rows_max, "aero_scale", s.aero_scale.size());
    if (s.believed) {
        at_most(scenario_rows_max, "believed.density_scale", s.believed->density_scale.size());
        at_most(scenario_rows_max, "believed.aero_scale", s.believed->aero_scale.size());
        at_most(scenario_rows_max, "believed.air", s.believed->air.size());
        at_most(scenario_rows_max, "believed.winds", s.believed->winds.size());
    }
    at_most(scenario_rows_max, "air", s.air.size());
    at_most(scenario_rows_max, "winds", s.winds.size());
    at_most(scenario_rows_max, "commands", s.commands.size());
    at_most(scenario_rows_max, "second_person", s.second_person.size());
    at_most(scenario_rows_max, "system_faults", s.system_faults.size());
    at_most(scenario_rows_max, "device_faults", s.device_faults.size());
    at_most(scenario_rows_max, "computer_resets", s.computer_resets.size());
    at_most(scenario_rows_max, "station_outages", s.station_outages.size());
    at_most(scenario_rows_max, "orbiter_outages", s.orbiter_outages.size());
    at_most(scenario_rows_max, "uhf_losses", s.uhf_losses.size());
    at_most(scenario_rows_max, "wind_shifts", s.wind_shifts.size());
    at_most(scenario_rows_max, "air_shifts", s.air_shifts.size());
    at_most(scenario_rows_max, "sensor_errors", s.sensor_errors.size());
    at_most(scenario_rows_max, "false_tones", s.false_tones.size());
    if (!found.empty()) return;
    for (std::size_t i = 0; i < s.radio.relay_passes.size(); ++i)
        at_most(scenario_rows_max, "radio.relay_passes[" + std::to_string(i) + "].rates",
                s.radio.relay_passes[i].rates.size());
    for (std::size_t i = 0; i < s.commands.size(); ++i)
        at_most(scenario_rows_max, "commands[" + std::to_string(i) + "].arguments", s.commands[i].arguments.size());
}

void check_masses(const Masses& masses, std::vector<std::string>& found) {
    if (masses.powered_descent_kg <= masses.propellant_kg + masses.rover_kg)
        found.push_back("masses.powered_descent_kg: " + number(masses.powered_descent_kg) +
                        " leaves nothing for the descent stage beside propellant and rover");
    const double parts_kg = masses.powered_descent_kg + masses.backshell_and_parachute_kg + masses.heatshield_kg +
                            6.0 * masses.entry_balance_each_kg;
    if (!(std::abs(parts_kg - masses.entry_kg) <= 1.0))
        found.push_back("masses.entry_kg: " + number(masses.entry_kg) + " is not the sum of its parts, " +
                        number(parts_kg));
}

/// The corners of the entry reference descend, and the parachute comes after them.
void check_reference(const Scenario& s, std::vector<std::string>& found) {
    struct Corner {
        const char* name;
        double speed_mps, apart_min_mps;
    };
    const std::array corners{Corner{"guidance.reference_turn_mps", s.guidance.reference_turn_mps, 0.0},
                             Corner{"guidance.reference_held_from_mps", s.guidance.reference_held_from_mps, 0.0},
                             Corner{"guidance.reference_held_to_mps", s.guidance.reference_held_to_mps, 1.0},
                             Corner{"guidance.reference_up_mps", s.guidance.reference_up_mps, 0.0},
                             Corner{"triggers.parachute_speed_mps", s.parachute_speed_mps, 0.0}};
    for (std::size_t i = 1; i < corners.size(); ++i)
        if (!(corners[i - 1].speed_mps >= corners[i].speed_mps + corners[i - 1].apart_min_mps))
            found.push_back(std::string{corners[i - 1].name} + ": " + number(corners[i - 1].speed_mps) +
                            " lies below " + corners[i].name + ", " + number(corners[i].speed_mps));
}

void check_density_scale(const std::vector<DensityScale>& scales, std::vector<std::string>& found) {
    for (std::size_t i = 0; i < scales.size(); ++i) {
        const std::string name = "density_scale[" + std::to_string(i) + "]";
        if (!(scales[i].scale >= 0.1 && scales[i].scale <= 10.0))
            found.push_back(name + ".scale: " + number(scales[i].scale) + " is outside 0.1 … 10");
        if (!(scales[i].deviation >= 0.0 && scales[i].deviation <= 0.5))
            found.push_back(name + ".deviation: " + number(scales[i].deviation) + " is outside 0 … 0.5");
        if (!(scales[i].altitude_m >= -5000.0 && scales[i].altitude_m <= 250000.0))
            found.push_back(name + ".altitude_m: " + number(scales[i].altitude_m) + " is outside -5000 … 250000");
        if (i > 0 && !(scales[i].altitude_m > scales[i - 1].altitude_m))
            found.push_back(name + ".altitude_m: " + number(scales[i].altitude_m) +
                            " does not lie above the one before");
    }
}

/// Rows over height: each above the one before, at least two.
template <typename Row>
void check_heights(const std::vector<Row>& rows, const char* list, std::vector<std::string>& found) {
    if (rows.size() == 1) found.push_back(std::string{list} + ": one row is no table over height");
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const std::string name = std::string{list} + "[" + std::to_string(i) + "].altitude_m: ";
        if (!(rows[i].altitude_m >= -10000.0 && rows[i].altitude_m <= 1.0e6))
            found.push_back(name + number(rows[i].altitude_m) + " is outside -10000 … 1000000");
        if (i > 0 && !(rows[i].altitude_m > rows[i - 1].altitude_m))
            found.push_back(name + number(rows[i].altitude_m) + " does not lie above the one before");
    }
}

void check_air(const Scenario& s, std::vector<std::string>& found) {
    check_heights(s.air, "air", found);
    check_heights(s.winds, "winds", found);
    const auto within = [&](const char* list, std::size_t i, const char* field, double value, double least,
                            double most) {
        if (!(value >= least && value <= most))
            found.push_back(std::string{list} + "[" + std::to_string(i) + "]." + field + ": " + number(value) +
                            " is outside " + number(least) + " … " + number(most));
    };
    for (std::size_t i = 0; i < s.air.size(); ++i) {
        within("air", i, "temperature_K", s.air[i].temperature_K, 50.0, 500.0);
        within("air", i, "density_kgm3", s.air[i].density_kgm3, 1.0e-20, 1.0);
    }
    for (std::size_t i = 0; i < s.winds.size(); ++i) {
        within("winds", i, "east_mps", s.winds[i].east_mps, -300.0, 300.0);
        within("winds", i, "north_mps", s.winds[i].north_mps, -300.0, 300.0);
    }
    constexpr double low_m = 1000.0, high_m = 100'000.0;  // our assumption: what an entry flies through
    if (!s.air.empty() && (s.air.front().altitude_m > low_m || s.air.back().altitude_m < high_m))
        found.push_back("air: covers " + number(s.air.front().altitude_m) + " … " + number(s.air.back().altitude_m) +
                        " m above the landing radius, an entry needs " + number(low_m) + " … " + number(high_m));
}

void check_aero_scale(const std::vector<AeroScale>& rows, std::vector<std::string>& found) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const std::string name = "aero_scale[" + std::to_string(i) + "].";
        for (const auto& [field, value, least, most] : {std::tuple{"mach", rows[i].mach, 0.0, 100.0},
                                                        {"drag", rows[i].drag, 0.5, 2.0},
                                                        {"lift", rows[i].lift, 0.1, 3.0}})
            if (!(value >= least && value <= most))
                found.push_back(name + field + ": " + number(value) + " is outside " + number(least) + " … " +
                                number(most));
        if (i > 0 && !(rows[i].mach > rows[i - 1].mach))
            found.push_back(name + "mach: " + number(rows[i].mach) + " does not lie above the one before");
    }
}

void check_grid(const Scenario& s, std::vector<std::string>& found) {
    if (!s.ground.grid) return;
    constexpr double least_m = 1000.0;  // our assumption: what the radar sees from where it decides
    const double reach_m = std::max(least_m, 0.5 * s.target.ellipse_major_m);
    if (!s.ground.grid->covers(reach_m))
        found.push_back("ground.grid: does not reach " + number(reach_m) +
                        (reach_m > least_m ? " m from the target to all sides, as the target's ellipse does"
                                           : " m from the target to all sides"));
    if (const double at_target_m = s.ground.grid->height_m(0.0, 0.0); std::abs(at_target_m) > 1000.0)
        found.push_back("ground.grid: at the target it lies " + number(at_target_m) +
                        " m over the landing radius: is that the zero of its heights (grid_landing_m)?");
}

bool is_word(const std::string& word) {
    return !word.empty() && std::ranges::all_of(word, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
    });
}

void check_relay_pass(const RelayPass& pass, const std::string& name, std::vector<std::string>& found) {
    const auto within = [&](const char* field, double value, double least, double most) {
        if (!(value >= least && value <= most))
            found.push_back(name + "." + field + ": " + number(value) + " is outside " + number(least) + " … " +
                            number(most));
    };
    if (!is_word(pass.orbiter) || pass.orbiter.size() > 16 || pass.orbiter == "live")  // it names links: uhf_<orbiter>
        found.push_back(name + ".orbiter: '" + pass.orbiter + "' is not 1 … 16 of a-z, 0-9 and _, or is 'live'");
    within("rise_after_entry_s", pass.rise_after_entry_s, -1.0e6, 1.0e6);
    within("set_after_entry_s", pass.set_after_entry_s, -1.0e6, 1.0e6);
    if (!(pass.set_after_entry_s > pass.rise_after_entry_s))
        found.push_back(name + ".set_after_entry_s: " + number(pass.set_after_entry_s) + " is not after its rise");
    within("horizon_km", pass.horizon_km, 0.0, 1.0e6);
    within("nearest_km", pass.nearest_km, 0.0, pass.horizon_km);
    within("delivery_after_set_s", pass.delivery_after_set_s, 0.0, 1.0e6);
    within("delivery_rate_bps", pass.delivery_rate_bps, 1000.0, 1.0e8);
    for (const RelayPass::Rate& rate : pass.rates) within("rates.bps", rate.bps, 1000.0, 1.0e8);
    if (!std::ranges::is_sorted(pass.rates, {}, &RelayPass::Rate::after_rise_s))
        found.push_back(name + ".rates: are not in the order of after_rise_s");
}

void check_relay_passes(const Radio& radio, std::vector<std::string>& found) {
    for (std::size_t i = 0; i < radio.relay_passes.size(); ++i)
        check_relay_pass(radio.relay_passes[i], "radio.relay_passes[" + std::to_string(i) + "]", found);
    for (const double restart : radio.delivery_restarts_after_touchdown_s)
        if (!(restart >= 0.0 && restart <= 1.0e6))
            found.push_back("radio.delivery_restarts_after_touchdown_s: " + number(restart) +
                            " is outside 0 … 1000000");
    if (!std::ranges::is_sorted(radio.delivery_restarts_after_touchdown_s))
        found.push_back("radio.delivery_restarts_after_touchdown_s: are not in order");
}

void check_tracking_passes(const std::vector<TrackingPass>& passes, std::vector<std::string>& found) {
    constexpr double most_s = 1.0e6;  // our assumption: eleven days
    for (std::size_t i = 0; i < passes.size(); ++i) {
        const TrackingPass& pass = passes[i];
        const std::string name = "radio.tracking_passes[" + std::to_string(i) + "]";
        if (pass.station.empty() || pass.station.size() > 32)
            found.push_back(name + ".station: a name of 1 … 32 octets is wanted");
        if (!(pass.begin_after_entry_s >= -most_s && pass.end_after_entry_s <= most_s &&
              pass.end_after_entry_s > pass.begin_after_entry_s))
            found.push_back(name + ": begin_after_entry_s " + number(pass.begin_after_entry_s) +
                            " to end_after_entry_s " + number(pass.end_after_entry_s) +
                            " is no stretch of time within " + number(most_s) + " s of entry");
    }
}

void check_tone_outages(const std::vector<ToneOutage>& outages, std::vector<std::string>& found) {
    for (std::size_t i = 0; i < outages.size(); ++i) {
        const std::string name = "radio.tone_outages[" + std::to_string(i) + "]";
        if (!is_word(outages[i].event))
            found.push_back(name + ".event: '" + outages[i].event + "' is no event, as parachute_deploy or earth_set");
        if (!(outages[i].from_s >= -86400.0 && outages[i].to_s <= 86400.0 && outages[i].to_s > outages[i].from_s))
            found.push_back(name + ": from_s " + number(outages[i].from_s) + " to to_s " + number(outages[i].to_s) +
                            " is no stretch of time within a day");
    }
}

void check_dispersion_moment(const Scenario& scenario, std::vector<std::string>& found) {
    if (!scenario.disperse_before_entry_s) return;
    const double before_entry_s = *scenario.disperse_before_entry_s;
    const std::string field = "disperse_before_entry_s: " + number(before_entry_s);
    if (!(before_entry_s >= 0.0 && before_entry_s <= scenario.start_before_entry_s))
        found.push_back(field + " is not between the start and entry");
    else if (!is_multiple_of_tick(before_entry_s))
        found.push_back(field + " is not a multiple of 1/64 s");
}

void check_commands(const Scenario& scenario, std::vector<std::string>& found) {
    for (std::size_t i = 0; i < scenario.commands.size(); ++i) {
        const ScriptedCommand& command = scenario.commands[i];
        const std::string name = "commands[" + std::to_string(i) + "]";
        if (command.command.empty()) found.push_back(name + ".command: is empty");
        if (!(command.send_before_entry_s <= scenario.start_before_entry_s &&
              command.send_before_entry_s >= -scenario.timeout_after_entry_s))
            found.push_back(name + ".send_before_entry_s: " + number(command.send_before_entry_s) +
                            " is not within the run");
    }
}

/// Whether a device can have the fault: only commanded devices can refuse or be late, only data sources can lose data.
bool is_possible(flight::Device device, DeviceFault::Kind kind) {
    using flight::Device;
    const bool sensor = device == Device::radar || device == Device::imu || device == Device::rover_imu;
    switch (kind) {
    case DeviceFault::Kind::silent: return true;
    case DeviceFault::Kind::refuses: return !sensor;
    case DeviceFault::Kind::late:
    case DeviceFault::Kind::doubled:
    case DeviceFault::Kind::claims:
    case DeviceFault::Kind::denies: return !sensor && device != Device::descent_engines;
    case DeviceFault::Kind::dropout: return sensor || device == Device::uhf;
    }
    return false;
}

void check_device_faults(const Scenario& scenario, std::vector<std::string>& found) {
    for (std::size_t i = 0; i < scenario.device_faults.size(); ++i) {
        const DeviceFault& fault = scenario.device_faults[i];
        const std::string name = "device_faults[" + std::to_string(i) + "]";
        if (!is_possible(fault.device, fault.kind))
            found.push_back(name + ".kind: is not possible for this device (sensors: silent, dropout; uhf: all; "
                                   "descent_engines: silent, refuses; others: all but dropout)");
        if (fault.device == flight::Device::rover_imu && fault.unit != flight::Unit::a)
            found.push_back(name + ".unit: the rover has one IMU, unit A");
        if (!(fault.begin_before_entry_s <= scenario.start_before_entry_s &&
              fault.begin_before_entry_s >= -scenario.timeout_after_entry_s))
            found.push_back(name + ".begin_before_entry_s: " + number(fault.begin_before_entry_s) +
                            " is not within the run");
        if (!(fault.duration_s > 0.0))
            found.push_back(name + ".duration_s: " + number(fault.duration_s) + " is not above 0");
        if (!(fault.late_s >= 0.0 && fault.late_s <= 3600.0))
            found.push_back(name + ".late_s: " + number(fault.late_s) + " is outside 0 … 3600");
    }
}

/// Checks the rows of whatever begins and lasts.
template <typename Row>
void check_spells(const Scenario& scenario, const std::vector<Row>& rows, const std::string& field,
                  std::vector<std::string>& found) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Row& fault = rows[i];
        const std::string name = field + "[" + std::to_string(i) + "]";
        if (!(fault.begin_before_entry_s <= scenario.start_before_entry_s &&
              fault.begin_before_entry_s >= -scenario.timeout_after_entry_s))
            found.push_back(name + ".begin_before_entry_s: " + number(fault.begin_before_entry_s) +
                            " is not within the run");
        if (!(fault.duration_s > 0.0))
            found.push_back(name + ".duration_s: " + number(fault.duration_s) + " is not above 0");
    }
}

void check_uhf_losses(const Scenario& scenario, std::vector<std::string>& found) {
    check_spells(scenario, scenario.uhf_losses, "uhf_losses", found);
    for (std::size_t i = 0; i < scenario.uhf_losses.size(); ++i)
        if (const double fraction = scenario.uhf_losses[i].fraction; !(fraction > 0.0 && fraction <= 0.9))
            found.push_back("uhf_losses[" + std::to_string(i) + "].fraction: " + number(fraction) +
                            " is not above 0 and up to 0.9");
}

void check_wind_shifts(const Scenario& scenario, std::vector<std::string>& found) {
    check_spells(scenario, scenario.wind_shifts, "wind_shifts", found);
    for (std::size_t i = 0; i < scenario.wind_shifts.size(); ++i)
        for (const auto& [name, mps] : {std::pair{"east_mps", scenario.wind_shifts[i].east_mps},
                                        std::pair{"north_mps", scenario.wind_shifts[i].north_mps}})
            if (!(mps >= -100.0 && mps <= 100.0))
                found.push_back("wind_shifts[" + std::to_string(i) + "]." + name + ": " + number(mps) +
                                " is outside -100 … 100");
}

void check_air_shifts(const Scenario& scenario, std::vector<std::string>& found) {
    check_spells(scenario, scenario.air_shifts, "air_shifts", found);
    for (std::size_t i = 0; i < scenario.air_shifts.size(); ++i)
        if (const double fraction = scenario.air_shifts[i].fraction;
            !(fraction >= -0.5 && fraction <= 1.0 && fraction != 0.0))
            found.push_back("air_shifts[" + std::to_string(i) + "].fraction: " + number(fraction) +
                            " is 0 or outside -0.5 … 1");
}

void check_sensor_errors(const Scenario& scenario, std::vector<std::string>& found) {
    check_spells(scenario, scenario.sensor_errors, "sensor_errors", found);
    for (std::size_t i = 0; i < scenario.sensor_errors.size(); ++i) {
        const SensorError& error = scenario.sensor_errors[i];
        const std::string name = "sensor_errors[" + std::to_string(i) + "].";
        if (error.device != flight::Device::imu && error.device != flight::Device::radar)
            found.push_back(name + "device: only the IMU and the radar measure what can be off");
        if (error.off_by == 0.0 && error.grows_per_s == 0.0)
            found.push_back(name + "off_by: neither it nor grows_per_s is other than 0");
        for (const auto& [field, value] :
             {std::pair{"off_by", error.off_by}, std::pair{"grows_per_s", error.grows_per_s},
              std::pair{"grows_per_s", error.grows_per_s * error.duration_s}})
            if (!(value >= -100.0 && value <= 100.0))
                found.push_back(name + field + ": " + number(value) + " is outside -100 … 100");
    }
}

void check_computer_resets(const Scenario& scenario, std::vector<std::string>& found) {
    for (std::size_t i = 0; i < scenario.computer_resets.size(); ++i) {
        const double before_entry_s = scenario.computer_resets[i].before_entry_s;
        const bool possible = is_multiple_of_tick(before_entry_s) && before_entry_s < scenario.start_before_entry_s &&
                              before_entry_s > -scenario.timeout_after_entry_s;
        if (!possible)
            found.push_back("computer_resets[" + std::to_string(i) + "].before_entry_s: " + number(before_entry_s) +
                            " is no multiple of 1/64 s within the run");
    }
}

/// Rejects settings that have no effect in the test venue.
void check_test_venue(const Scenario& scenario, std::vector<std::string>& found) {
    if (scenario.test_venue != TestVenue::gnc_alone) return;
    const auto refuse = [&](bool any, const char* field) {
        if (any)
            found.push_back(std::string(field) + ": in the test venue gnc_alone there is no computer that takes them");
    };
    refuse(!scenario.commands.empty(), "commands");
    refuse(!scenario.system_faults.empty(), "system_faults");
    refuse(!scenario.computer_resets.empty(), "computer_resets");
}

}  // namespace

const char* name_of(TestVenue venue) {
    switch (venue) {
    case TestVenue::flight_software: return "flight_software";
    case TestVenue::gnc_alone: return "gnc_alone";
    case TestVenue::all_but_gnc: return "all_but_gnc";
    case TestVenue::performance: return "performance";
    }
    return "flight_software";
}

bool disperses_later(const Scenario& scenario) {
    return scenario.disperse_before_entry_s && *scenario.disperse_before_entry_s < scenario.start_before_entry_s;
}

Scenario undispersed(Scenario scenario) {
    // Each of its fields is a deviation, so a new field cannot be forgotten.
    scenario.dispersions = std::bit_cast<Dispersions>(std::array<double, sizeof(Dispersions) / sizeof(double)>{});
    for (DensityScale& row : scenario.density_scale) row.deviation = 0.0;
    if (scenario.believed)
        for (DensityScale& row : scenario.believed->density_scale) row.deviation = 0.0;
    return scenario;
}

Target aimed_target(const Scenario& scenario) {
    Target target = scenario.target;
    const auto& [east_m, north_m] = std::pair{scenario.guidance.aim_east_m, scenario.guidance.aim_north_m};
    if (east_m == 0.0 && north_m == 0.0) return target;
    const Vector3 up = place(target.latitude_deg * degree_rad, target.longitude_deg * degree_rad, 1.0);
    const Horizon local = horizon(up);
    const Vector3 aim = target.radius_m * up + east_m * local.east + north_m * local.north;
    target.latitude_deg = latitude_rad(aim) / degree_rad;
    target.longitude_deg += std::remainder(longitude_rad(aim) / degree_rad - target.longitude_deg, 360.0);
    return target;
}

Scenario as_believed(Scenario scenario) {
    if (!scenario.believed) return scenario;
    const Belief& belief = *scenario.believed;
    scenario.masses = belief.masses;
    scenario.density_scale = belief.density_scale;
    scenario.aero_scale = belief.aero_scale;
    scenario.parachute_drag_area_m2 = belief.parachute_drag_area_m2;
    scenario.steady_wind_east_mps = belief.steady_wind_east_mps;
    scenario.steady_wind_north_mps = belief.steady_wind_north_mps;
    scenario.air = belief.air;
    scenario.winds = belief.winds;
    scenario.believed.reset();
    return scenario;
}

double course_at_target_deg(const Scenario& s) {
    const Vector3 entry = place(s.entry.latitude_deg * degree_rad, s.entry.longitude_deg * degree_rad, 1.0);
    const Horizon local = horizon(place(s.target.latitude_deg * degree_rad, s.target.longitude_deg * degree_rad, 1.0));
    // At the target the course leads away from entry.
    const double azimuth_rad = std::atan2(-entry.dot(local.east), -entry.dot(local.north));
    return (azimuth_rad < 0.0 ? azimuth_rad + 2.0 * std::numbers::pi : azimuth_rad) / degree_rad;
}

// Wider than any entry of this design reaches, so that only mistakes are refused.
void check_target_range(const Scenario& s, std::vector<std::string>& found) {
    constexpr double least_km = 300.0,
                     most_km = 1500.0;  // our assumption; this vehicle steers within some 520 … 800 km
    const auto direction = [](double latitude_deg, double longitude_deg) {
        return place(latitude_deg * degree_rad, longitude_deg * degree_rad, 1.0);
    };
    const Vector3 entry = direction(s.entry.latitude_deg, s.entry.longitude_deg);
    const Vector3 target = direction(s.target.latitude_deg, s.target.longitude_deg);
    const double range_km = 1.0e-3 * s.target.radius_m * std::atan2(entry.cross(target).norm(), entry.dot(target));
    if (!(range_km >= least_km && range_km <= most_km))
        found.push_back("target: out of range: " + number(std::round(range_km)) + " km from entry is outside " +
                        number(least_km) + " … " + number(most_km) + " km");
}

// What is believed has the bounds of what is so.
void check_belief(const Scenario& scenario, std::vector<std::string>& found) {
    if (!scenario.believed) return;
    const Scenario world = as_believed(scenario);
    std::vector<std::string> wrong;
    for (const Bounded& field : bounded_fields(world))
        if (!(field.value >= field.least && field.value <= field.most))
            wrong.push_back(std::string(field.name) + ": " + number(field.value) + " is outside " +
                            number(field.least) + " … " + number(field.most));
    check_masses(world.masses, wrong);
    check_density_scale(world.density_scale, wrong);
    check_aero_scale(world.aero_scale, wrong);
    check_air(world, wrong);
    const Belief& belief = *scenario.believed;
    for (const auto& [field, value, most] : {std::tuple{"gravity_fraction", belief.gravity_fraction, 0.01},
                                             {"position_east_m", belief.position_east_m, 50000.0},
                                             {"position_north_m", belief.position_north_m, 50000.0},
                                             {"position_up_m", belief.position_up_m, 10000.0},
                                             {"attitude_x_deg", belief.attitude_x_deg, 5.0},
                                             {"attitude_y_deg", belief.attitude_y_deg, 5.0},
                                             {"attitude_z_deg", belief.attitude_z_deg, 5.0}})
        if (!(std::abs(value) <= most))
            wrong.push_back(std::string(field) + ": " + number(value) + " is outside " + number(-most) + " … " +
                            number(most));
    // What is wrong with the truth as well is told of the truth.
    for (const std::string& one : wrong)
        if (std::ranges::find(found, one) == found.end()) found.push_back("believed." + one);
}

std::vector<std::string> impossible_values(const Scenario& scenario) {
    std::vector<std::string> found;
    check_list_sizes(scenario, found);
    if (!found.empty()) return found;  // one line, not one for each row of an overlong list
    // "Not within" instead of "outside", because a NaN is neither.
    for (const Bounded& field : bounded_fields(scenario))
        if (!(field.value >= field.least && field.value <= field.most))
            found.push_back(std::string(field.name) + ": " + number(field.value) + " is outside " +
                            number(field.least) + " … " + number(field.most));
    if (scenario.name.empty()) found.push_back("name: is empty");
    if (scenario.entry_scet.microseconds == 0) found.push_back("entry_scet: is missing");
    if (!is_multiple_of_tick(scenario.entry_sclk.seconds))
        found.push_back("entry_sclk: " + number(scenario.entry_sclk.seconds) + " is not a multiple of 1/64 s");
    if (!is_multiple_of_tick(scenario.start_before_entry_s))
        found.push_back("start_before_entry_s: " + number(scenario.start_before_entry_s) +
                        " is not a multiple of 1/64 s");
    if (!(scenario.radio.blackout_end_speed_mps <= scenario.radio.blackout_start_speed_mps))
        found.push_back("radio.blackout_end_speed_mps: " + number(scenario.radio.blackout_end_speed_mps) +
                        " is above the speed at which the blackout starts");
    check_target_range(scenario, found);
    check_masses(scenario.masses, found);
    check_relay_passes(scenario.radio, found);
    check_tracking_passes(scenario.radio.tracking_passes, found);
    check_tone_outages(scenario.radio.tone_outages, found);
    check_density_scale(scenario.density_scale, found);
    check_aero_scale(scenario.aero_scale, found);
    check_reference(scenario, found);
    check_grid(scenario, found);
    check_air(scenario, found);
    check_belief(scenario, found);
    check_dispersion_moment(scenario, found);
    check_commands(scenario, found);
    check_spells(scenario, scenario.system_faults, "system_faults", found);
    check_spells(scenario, scenario.station_outages, "station_outages", found);
    check_spells(scenario, scenario.orbiter_outages, "orbiter_outages", found);
    check_uhf_losses(scenario, found);
    check_wind_shifts(scenario, found);
    check_air_shifts(scenario, found);
    check_sensor_errors(scenario, found);
    check_spells(scenario, scenario.false_tones, "false_tones", found);
    check_device_faults(scenario, found);
    check_computer_resets(scenario, found);
    check_test_venue(scenario, found);
    return found;
}

}  // namespace aeolis::simulation
