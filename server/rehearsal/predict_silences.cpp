// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/predict_silences.hpp"

#include "dictionaries/timeline_plan.hpp"
#include "simulation/entry_flight.hpp"
#include "simulation/entry_reference.hpp"
#include "simulation/links/carrier_model.hpp"
#include "simulation/mars/earth.hpp"

#include <algorithm>

namespace aeolis::server {
namespace {

using telemetry::PredictedSilences;

constexpr double flown_step_s = 0.25, longest_entry_s = 900.0;    // chosen
constexpr double held_bank_rad = 50.0 * simulation::degree_rad;   // chosen near the reference; blackout ends soon after
constexpr double earth_step_s = 1.0, earth_looked_for_s = 900.0;  // chosen

/// The nominal entry down to the speed of parachute deployment.
struct NominalEntry {
    std::optional<PredictedSilences::Window> blackout;
    double parachute_s = 0.0, parachute_altitude_m = 0.0;
};

NominalEntry fly_entry(const simulation::Scenario& scenario) {
    const simulation::Radio& radio = scenario.radio;
    const simulation::EntryFlight flight{scenario};
    simulation::PointMass at = simulation::nominal_entry(scenario);
    const simulation::Target aim = simulation::aimed_target(scenario);
    const simulation::Vector3 aim_M =
        simulation::place(aim.latitude_deg * simulation::degree_rad, aim.longitude_deg * simulation::degree_rad, 1.0);
    NominalEntry entry;
    for (double t = 0.0; t < longest_entry_s; t += flown_step_s) {
        const double speed_mps = at.v_MB_M.norm();
        entry.parachute_s = t;
        entry.parachute_altitude_m = flight.altitude_m(at);
        const double to_aim_m = aim.radius_m * std::acos(std::clamp(at.p_MoB_M.normalized().dot(aim_M), -1.0, 1.0));
        const bool near = scenario.parameters.parachute_range_m > 0.0 &&
                          speed_mps <= scenario.parameters.sufr_low_speed_mps &&
                          to_aim_m <= scenario.parameters.parachute_range_m;
        if (near || speed_mps <= scenario.parachute_speed_mps ||
            entry.parachute_altitude_m <= scenario.backshell_altitude_m)
            break;
        const bool begun =
            entry.parachute_altitude_m < radio.blackout_start_altitude_m || speed_mps < radio.blackout_start_speed_mps;
        if (!entry.blackout && begun && speed_mps >= radio.blackout_end_speed_mps) entry.blackout = {t, t};
        if (entry.blackout && speed_mps >= radio.blackout_end_speed_mps) entry.blackout->to_s = t + flown_step_s;
        // Only the vertical part of lift counts: reversals alternate the lateral part.
        const double upright = std::cos(simulation::reference_bank_rad(scenario, speed_mps, held_bank_rad));
        at = simulation::runge_kutta_step(
            at, flown_step_s,
            [&](double, const simulation::Vector3& p, const simulation::Vector3& v) -> simulation::Vector3 {
                const simulation::Sensed by = flight.sensed({p, v});
                return -by.drag_mps2 * v.normalized() + upright * by.lift_mps2 * simulation::lift_direction(p, v, 0.0);
            });
    }
    return entry;
}

/// When Earth sets over the target, for a descent at a constant rate. The rate is that between parachute deployment and
/// backshell separation, down to the ground.
/// @param backshell_s  0: not predicted
std::optional<double> earth_set_s(const simulation::Scenario& scenario, const NominalEntry& entry, double backshell_s) {
    if (scenario.radio.earth_set_after_entry_s) return scenario.radio.earth_set_after_entry_s;
    if (backshell_s <= entry.parachute_s) return {};
    const double sink_mps =
        (entry.parachute_altitude_m - scenario.backshell_altitude_m) / (backshell_s - entry.parachute_s);
    for (double t = entry.parachute_s; t < earth_looked_for_s; t += earth_step_s) {
        const double altitude_m = std::max(0.0, entry.parachute_altitude_m - sink_mps * (t - entry.parachute_s));
        const auto p_MoB_M = simulation::place(scenario.target.latitude_deg * simulation::degree_rad,
                                               scenario.target.longitude_deg * simulation::degree_rad,
                                               scenario.target.radius_m + altitude_m);
        if (!simulation::earth_is_up(p_MoB_M, t, scenario.target.radius_m)) return t;
    }
    return {};
}

}  // namespace

telemetry::PredictedSilences predict_silences(const simulation::Scenario& scenario,
                                              const dictionary::Dictionary& dictionary) {
    const auto timepoints = dictionary::predicted_from_entry_s(dictionary, dictionary.predicted_anchor_e_s, {});
    const auto timepoint_s = [&](std::string_view action) -> std::optional<double> {
        const auto row = std::ranges::find(dictionary.timeline, action, &dictionary::TimelineRow::action);
        if (row == dictionary.timeline.end()) return {};
        return timepoints[static_cast<std::size_t>(row - dictionary.timeline.begin())];
    };
    double backshell_s = 0.0;
    for (const auto& anchor : dictionary.anchors)
        if (anchor.name == "backshell") backshell_s = dictionary.predicted_anchor_e_s[anchor.id.value].value_or(0.0);
    const NominalEntry entry = fly_entry(scenario);
    PredictedSilences silences;
    silences.blackout = entry.blackout;
    silences.hand_over_s = timepoint_s("select_parachute_antenna");
    silences.uhf_start_s = timepoint_s("start_uhf");
    silences.uhf_stop_s = timepoint_s("stop_uhf");
    silences.x_band_tones_s = timepoint_s("start_x_band_tones");
    silences.earth_set_s = earth_set_s(scenario, entry, backshell_s);
    silences.carrier_weak = !simulation::CarrierModel::can_acquire(scenario.radio.x_band_c_n0_dbhz);
    for (const simulation::RelayPass& pass : scenario.radio.relay_passes)
        silences.passes.push_back({pass.orbiter, pass.rise_after_entry_s, pass.set_after_entry_s,
                                   pass.set_after_entry_s + pass.delivery_after_set_s, pass.stored});
    silences.light_time_s = scenario.radio.light_time_s;
    return silences;
}

}  // namespace aeolis::server
