// SPDX-License-Identifier: Apache-2.0
#include "simulation/venues/gnc_stand_in.hpp"

#include "flight/gnc/mars.hpp"
#include "simulation/mars/mars.hpp"
#include "simulation/vectors.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::simulation {
namespace {

using flight::GncModeEvent;
using flight::Quantity;
using flight::gnc::at_least;
using flight::gnc::at_most;
using flight::gnc::Mode;
using flight::gnc::Trigger;
using Attitude = flight::gnc::AttitudeCommand::Mode;

constexpr double sufr_mps = 453.0;  // [od137]
constexpr double priming_above_backshell_m = 1340.0;
constexpr double approach_end_m = 150.0, slow_below_m = 32.0;
constexpr double sidestep_mps = 12.0;  // during the approach: out from under the backshell

/// Bank angle, roughly as in [od137].
double bank_deg(const flight::Parameters& parameters, const TruthState& truth) {
    if (truth.speed_mps <= parameters.heading_alignment_speed_mps) return 0.0;
    if (truth.e_s > 124.0) return -49.0;
    if (truth.e_s > 98.0) return 46.0;
    return truth.e_s > 72.0 ? -48.0 : 72.0;
}

int reversals(const TruthState& truth) {
    return (truth.e_s > 72.0) + (truth.e_s > 98.0) + (truth.e_s > 124.0);
}

/// Climb rate: two stretches of constant deceleration, then slow and steady.
double wanted_climb_mps(const flight::Parameters& parameters, double height_m) {
    if (height_m > approach_end_m)
        return -std::min(75.0, std::sqrt(parameters.constant_velocity_mps * parameters.constant_velocity_mps +
                                         6.0 * (height_m - approach_end_m)));
    if (height_m > slow_below_m) return -std::sqrt(0.56 + 8.6 * (height_m - slow_below_m));
    return -parameters.sky_crane_descent_rate_mps;
}

}  // namespace

bool GncStandIn::take(GncModeEvent event) {
    if (!mode_.take(event)) return false;
    mode_since_ = now_;
    return true;
}

bool GncStandIn::fire(Trigger trigger, const flight::gnc::Condition& condition) {
    if (fired(trigger) || told_.triggers.full() || !condition.holds) return false;
    fired_[static_cast<std::size_t>(trigger)] = true;
    flight::gnc::Conditions conditions;
    conditions.push_back(condition);
    told_.triggers.push_back({trigger, conditions});
    return true;
}

const flight::gnc::Output& GncStandIn::cycle(const World& world, const flight::gnc::Configuration& configuration) {
    told_ = {};
    now_ = world.sclk();
    follow(configuration);
    decide_in_air(world, configuration);
    decide_on_engines(world, configuration);
    guide(world, configuration);
    steer(world, configuration);
    report(world);
    return told_;
}

void GncStandIn::follow(const flight::gnc::Configuration& configuration) {
    if (configuration.enabled) take(GncModeEvent::enabled);
    if (configuration.guidance_armed) take(GncModeEvent::guidance_armed);
    if (now_ - mode_since_ >= load_.parameters.sufr_duration_s) take(GncModeEvent::straightened_up);
    take(configuration.parachute_out ? GncModeEvent::parachute_out : GncModeEvent::parachute_missing);
    if (configuration.backshell_gone) take(GncModeEvent::backshell_gone);
    if (configuration.sky_crane_started) take(GncModeEvent::throttled_down);
    if (configuration.touchdown_declared) take(GncModeEvent::touchdown_declared);
    if (configuration.flyaway_started) take(GncModeEvent::flyaway_started);
}

void GncStandIn::decide_in_air(const World& world, const flight::gnc::Configuration& configuration) {
    const TruthState truth = world.truth();
    const NavigationSolution& solution = world.solution();
    if (mode_.can(GncModeEvent::drag_felt) &&
        fire(Trigger::guidance_start,
             at_least(Quantity::drag_mps2, truth.sensed_mps2, load_.parameters.guidance_start_drag_mps2)))
        take(GncModeEvent::drag_felt);
    if (mode_.can(GncModeEvent::slow_for_heading) &&
        fire(Trigger::heading_alignment,
             at_most(Quantity::speed_mps, truth.speed_mps, load_.parameters.heading_alignment_speed_mps)))
        take(GncModeEvent::slow_for_heading);
    if (mode_.can(GncModeEvent::parachute_near) && configuration.sufr_allowed &&
        fire(Trigger::sufr_start, at_most(Quantity::speed_mps, truth.speed_mps, sufr_mps)))
        take(GncModeEvent::parachute_near);
    if (mode_.state() == Mode::wait_for_parachute)
        fire(Trigger::parachute, at_most(Quantity::speed_mps, truth.speed_mps, solution.parachute_speed_mps));
    if (mode_.state() != Mode::parachute_descent) return;
    const double parachute_s = configuration.parachute_time ? now_ - *configuration.parachute_time : 0.0;
    if (parachute_s > load_.parameters.heatshield_delay_min_s)
        fire(Trigger::heatshield, at_most(Quantity::speed_mps, truth.speed_mps, solution.heatshield_speed_mps));
    if (!configuration.heatshield_gone) return;
    if (configuration.radar_on)
        fire(Trigger::radar_lock,
             at_most(Quantity::altitude_m, truth.altitude_m, load_.parameters.radar_altitude_max_m));
    fire(Trigger::engine_priming,
         at_most(Quantity::altitude_m, truth.altitude_m, solution.backshell_altitude_m + priming_above_backshell_m));
    if (configuration.engines_primed)
        fire(Trigger::backshell, at_most(Quantity::altitude_m, truth.altitude_m, solution.backshell_altitude_m));
}

void GncStandIn::decide_on_engines(const World& world, const flight::gnc::Configuration& configuration) {
    const TruthState truth = world.truth();
    const double in_mode_s = now_ - mode_since_;
    switch (mode_.state()) {
    case Mode::free_fall:
        if (fire(Trigger::powered_approach,
                 at_least(Quantity::time_in_mode_s, in_mode_s, load_.parameters.powered_approach_delay_s)))
            take(GncModeEvent::fallen_clear);
        break;
    case Mode::powered_approach:
        if (fire(Trigger::constant_velocity, at_most(Quantity::altitude_m, truth.altitude_m, approach_end_m)))
            take(GncModeEvent::approached);
        break;
    case Mode::constant_velocity:
        if (fire(Trigger::constant_deceleration, at_most(Quantity::altitude_m, truth.altitude_m, approach_end_m)))
            take(GncModeEvent::low_enough);
        break;
    case Mode::constant_deceleration:
        fire(Trigger::sky_crane, at_most(Quantity::altitude_m, truth.altitude_m, slow_below_m - 2.0));
        break;
    case Mode::sky_crane:
        fire(Trigger::rover_separation,
             at_least(Quantity::time_in_mode_s, in_mode_s, load_.parameters.sky_crane_settle_s));
        if (configuration.touchdown_logic_ready && world.contact())
            fire(Trigger::touchdown,
                 at_least(Quantity::time_in_mode_s, now_ - *world.contact(), load_.parameters.touchdown_settle_s));
        break;
    default: break;
    }
}

void GncStandIn::guide(const World& world, const flight::gnc::Configuration& configuration) {
    const TruthState truth = world.truth();
    const Mode mode = mode_.state();
    if (mode == Mode::approach ? configuration.turning_to_entry
                               : mode >= Mode::wait_for_guidance_start && mode <= Mode::wait_for_parachute) {
        told_.attitude.mode = Attitude::entry_bank;
        told_.attitude.bank_rad = bank_deg(load_.parameters, truth) * degree_rad;
        if (mode == Mode::range_control && reversals(truth) > reversals_)
            told_.bank_reversal.number = static_cast<std::uint8_t>(++reversals_);
    } else if (mode == Mode::approach)
        told_.attitude.mode = Attitude::detumble;
    if (mode == Mode::parachute_descent) told_.attitude.mode = Attitude::suspended;
    if (mode < Mode::free_fall) return;

    const Horizon local = horizon(vector3(truth.p_MoB_M_m));
    const Vector3 v = vector3(truth.v_MB_M_mps);
    told_.attitude.mode = Attitude::thrust;
    told_.engines.ignited = configuration.engines_ignited && !configuration.engines_off;
    if (mode == Mode::flyaway) {
        told_.attitude.thrust_direction_M = array3((local.up + 0.8 * local.north).normalized());
        told_.engines.throttle.fill(0.9);
        return;
    }
    const double up_mps = v.dot(local.up);
    const double feed_forward_mps2 = truth.altitude_m > slow_below_m ? 3.0 : 0.0;
    const double climb_mps2 = flight::gnc::mars_weight_mps2 + feed_forward_mps2 +
                              1.2 * (wanted_climb_mps(load_.parameters, truth.altitude_m) - up_mps);
    const Vector3 wanted_level = (mode == Mode::powered_approach ? sidestep_mps : 0.0) * local.east;
    const Vector3 push = climb_mps2 * local.up - 0.3 * (v - up_mps * local.up - wanted_level);
    const double mass_kg = world.inspect().mass_kg - (world.contact() ? load_.rover_mass_kg : 0.0);
    const double thrust_N = std::min(25000.0, push.norm() * mass_kg);
    told_.attitude.thrust_direction_M = array3(push.normalized());
    const double full_N = load_.engine_max_thrust_N, least_N = load_.engine_min_thrust_N;
    for (std::size_t i = 0; i < told_.engines.throttle.size(); ++i)
        told_.engines.throttle[i] = !configuration.sky_crane_started ? thrust_N / 8 / full_N
                                    : i % 2 == 1                     ? 0.0
                                                                     : (thrust_N - 4 * least_N) / 4 / full_N;
}

// Attitude control is GNC's own, as part of the plant: only the decisions are replaced.
void GncStandIn::steer(const World& world, const flight::gnc::Configuration& configuration) {
    const World::Inspection seen = world.inspect();
    const TruthState truth = world.truth();
    const Mode mode = mode_.state();
    const bool rover_hangs = configuration.rover_separated && !configuration.bridle_cut;
    const double rigid_kg = seen.mass_kg - (rover_hangs ? load_.rover_mass_kg : 0.0);
    const flight::gnc::AttitudeState state{vector3(truth.p_MoB_M_m), vector3(truth.v_MB_M_mps),
                                           flight::gnc::to_quaternion(seen.q_MB), vector3(seen.rate_B_rps),
                                           mode >= Mode::range_control};
    steering_.cycle(load_.parameters, told_.attitude, state, flight::gnc::inertia_of(mode, configuration, rigid_kg),
                    flight::gnc::steers(mode, configuration, told_.engines), told_.thrusters, told_.engines);
}

void GncStandIn::report(const World& world) {
    const TruthState truth = world.truth();
    const World::Inspection seen = world.inspect();
    const Horizon local = horizon(vector3(truth.p_MoB_M_m));
    const Vector3 v = vector3(truth.v_MB_M_mps);
    told_.mode = mode_.state();
    told_.p_MoB_M_m = truth.p_MoB_M_m;
    told_.v_MB_M_mps = truth.v_MB_M_mps;
    told_.q_MB = seen.q_MB;
    told_.altitude_m = truth.altitude_m;
    told_.speed_mps = truth.speed_mps;
    told_.descent_rate_mps = -v.dot(local.up);
    told_.horizontal_speed_mps = (v - v.dot(local.up) * local.up).norm();
    told_.flight_path_deg = std::atan2(-told_.descent_rate_mps, told_.horizontal_speed_mps) / degree_rad;
    told_.bank_deg = seen.bank_deg;
    told_.bank_command_deg = told_.attitude.bank_rad / degree_rad;
    told_.angle_of_attack_deg = seen.angle_of_attack_deg;
    told_.drag_mps2 = mode_.state() < Mode::free_fall ? truth.sensed_mps2 : 0.0;
    told_.dynamic_pressure_Pa = seen.dynamic_pressure_Pa;
    told_.mach = seen.mach;
    told_.reversals = static_cast<std::uint8_t>(reversals_);
    told_.mass_kg = seen.mass_kg;
    told_.propellant_kg = seen.propellant_kg;
    told_.radar_locked = fired(Trigger::radar_lock);
}

}  // namespace aeolis::simulation
