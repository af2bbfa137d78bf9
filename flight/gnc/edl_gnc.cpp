// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/edl_gnc.hpp"

#include "common/check.hpp"
#include "flight/devices/effectors.hpp"
#include "flight/gnc/entry/heading_alignment.hpp"
#include "flight/gnc/entry/height_guard.hpp"
#include "flight/gnc/entry/range_control.hpp"
#include "flight/gnc/flyaway/flyaway.hpp"
#include "flight/gnc/mars.hpp"
#include "flight/gnc/powered_descent/thrust_allocation.hpp"
#include "flight/gnc/sufr/straighten_up.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace aeolis::flight::gnc {

namespace {

constexpr double cycle_s = seconds_per_tick;

/// A fact and its time: both become known together.
void set(bool& known, std::optional<Sclk>& when, Sclk since) {
    known = true;
    if (!when) when = since;
}
void clear(bool& known, std::optional<Sclk>& when) {
    known = false;
    when.reset();
}

}  // namespace

void Configuration::learn(Fact fact, Sclk since) {
    switch (fact) {
    case Fact::none: return;
    case Fact::pyros_armed: pyros_armed = true; return;
    case Fact::pyros_safe: pyros_armed = false; return;
    case Fact::thrusters_on: thrusters_on_time = thrusters_on_time.value_or(since); return;
    case Fact::cruise_stage_gone: cruise_stage_gone = true; return;
    case Fact::parachute_out: return set(parachute_out, parachute_time, since);
    case Fact::heatshield_gone: return set(heatshield_gone, heatshield_time, since);
    case Fact::engines_primed: engines_primed = true; return;
    case Fact::backshell_gone: return set(backshell_gone, backshell_time, since);
    case Fact::rover_separated: return set(rover_separated, rover_separation_time, since);
    case Fact::bridle_cut: bridle_cut = true; return;
    }
}

void Configuration::forget(Fact fact) {
    switch (fact) {
    case Fact::none: return;
    case Fact::pyros_armed: pyros_armed = false; return;
    case Fact::pyros_safe: pyros_armed = true; return;
    case Fact::thrusters_on: thrusters_on_time.reset(); return;
    case Fact::cruise_stage_gone: cruise_stage_gone = false; return;
    case Fact::parachute_out: return clear(parachute_out, parachute_time);
    case Fact::heatshield_gone: return clear(heatshield_gone, heatshield_time);
    case Fact::engines_primed: engines_primed = false; return;
    case Fact::backshell_gone: return clear(backshell_gone, backshell_time);
    case Fact::rover_separated: return clear(rover_separated, rover_separation_time);
    case Fact::bridle_cut: bridle_cut = false; return;
    }
}

EdlGnc::EdlGnc(const Load& load)
    : load_(load), strapdown_(load.gravity_fraction), mass_kg_(load.powered_descent_mass_kg),
      steering_(load.engine_max_thrust_N) {
    lateral_.start(1);
}

void EdlGnc::set_solution(const Solution& solution, Sclk now) {
    solution_ = solution;
    target_M_ = direction_of(solution.target_latitude_rad, solution.target_longitude_rad);
    if (load_.aim_east_m != 0.0 || load_.aim_north_m != 0.0) {
        const auto [east_M, north_M] = level_axes(target_M_);
        target_M_ = (solution.target_radius_m * target_M_ + load_.aim_east_m * east_M + load_.aim_north_m * north_M)
                        .normalized();
    }
    // Once the air is felt, the navigated state is better than ground's from hours ago: only the bounds are taken.
    if (navigating_ && mode() >= Mode::range_control) return;
    NavigatedState state;
    state.p_MoB_M = to_vector(solution.p_MoB_M_m);
    state.v_MB_M = to_vector(solution.v_MB_M_mps);
    state = propagate(state, now - solution.epoch);
    state.q_MB = strapdown_.state().q_MB;
    strapdown_.start(state);
    belief_ = {};
    navigating_ = true;
    navigated_to_ = now;
    measure(now);
}

void EdlGnc::on(const CruiseAttitude& attitude) {
    cruise_attitude_ = attitude;
    take_cruise_attitude();
}

// The attitude is valid at its tick, and the vehicle still spins, 3 mrad a tick. It is taken when the increments have
// reached that tick; if it arrives slightly late, it is rotated forward to them.
void EdlGnc::take_cruise_attitude() {
    if (!cruise_attitude_ || (navigating_ && cruise_attitude_->at > navigated_to_)) return;
    const CruiseAttitude attitude = *std::exchange(cruise_attitude_, std::nullopt);
    const double age_s = navigating_ ? navigated_to_ - attitude.at : 0.0;
    if (cruise_stage_gone_ || age_s > parameters().tick_apart_max_s) return;
    const Vector3 turned = strapdown_.rate_B_rps() * age_s;
    const double angle = turned.norm();
    const Quaternion since =
        angle > 0.0 ? Quaternion{Eigen::AngleAxisd{angle, turned / angle}} : Quaternion::Identity();
    strapdown_.set_attitude((to_quaternion(attitude.q_MB) * since).normalized());
}

std::optional<RadarDecision> EdlGnc::on(const RadarSolution& solution) {
    if (!navigating_ || solution.altitude_m > parameters().radar_altitude_max_m) return std::nullopt;
    last_radar_beams_ = solution.beams;
    last_radar_altitude_m_ = solution.altitude_m;
    const RadarJudgement judged = radar_filter_.on(parameters(), solution, measured_at_, measured_.up_M, belief_);
    if (judged.accepted()) {
        if (radar_filter_.accepted() == 1) radar_first_ = true;
        strapdown_.correct(judged.correction.altitude_m * measured_.up_M, judged.correction.v_M_mps);
        level_by(judged.correction);
    }
    const bool believed = judged.verdict == RadarJudgement::Verdict::believed;
    if (!believed && judged.verdict != RadarJudgement::Verdict::refused) return std::nullopt;
    return RadarDecision{believed, judged.conditions};
}

// With a tilted attitude, gravity is subtracted in a wrong direction, and velocity drifts sideways by tilt × g, which
// the radar shows. Used only after a silence of the IMU: otherwise the attitude is more exact than the radar's noise.
void EdlGnc::level_by(const RadarCorrection& correction) {
    if (belief_.attitude_rad() > 0.0 && correction.gain < 1.0) {
        const Vector3 residual_mps = correction.v_M_mps / correction.gain;
        strapdown_.turn(-parameters().level_gain_per_s / mars_weight_mps2 * residual_mps.cross(measured_.up_M));
        belief_.narrow_attitude(parameters());
    }
    belief_.hear_radar(correction.gain);
}

void EdlGnc::navigate(std::span<const ImuSample> imu, Sclk now) {
    if (!navigating_) return;
    const double passed_s = now - navigated_to_;
    if (passed_s <= 0.0) return;  // a solution was just taken, valid now: these increments are older
    navigated_to_ = now;
    if (imu.empty())
        reckon(passed_s);
    else
        reckoning_.end();
    belief_.pass(parameters(), reckoning_.silent_s() >= parameters().imu_silence_told_s, surroundings_.held_by,
                 strapdown_.specific_force_B_mps2().norm(), passed_s);
    const bool pushed = measured_.altitude_m < parameters().air_altitude_max_m || now <= pulses_felt_until_;
    for (const ImuSample& sample : imu) {
        const Vector3 force_B = to_vector(sample.delta_v_mps) / imu_period_s;
        smooth_force_B_mps2_ +=
            imu_period_s / (parameters().push_filter_time_s + imu_period_s) * (force_B - smooth_force_B_mps2_);
        strapdown_.on(parameters(), sample,
                      pushed || smooth_force_B_mps2_.squaredNorm() >
                                    parameters().push_felt_mps2 * parameters().push_felt_mps2);
    }
}

void EdlGnc::reckon(double passed_s) {
    if (passed_s > parameters().tick_apart_max_s) return strapdown_.coast(passed_s);
    surroundings_.altitude_m = measured_.altitude_m;
    surroundings_.free_M_mps2 = measured_.free_M_mps2;
    const ForceAndRate last{strapdown_.specific_force_B_mps2(), strapdown_.rate_B_rps()};
    const int ticks = static_cast<int>(std::ceil(passed_s / seconds_per_tick));
    for (int i = 0; i < ticks; ++i) {
        const ForceAndRate felt =
            reckoning_.reckon(parameters(), surroundings_, strapdown_.state(), last, seconds_per_tick);
        strapdown_.reckon(felt.force_B_mps2, felt.rate_B_rps, seconds_per_tick);
    }
}

void EdlGnc::measure(Sclk now) {
    measured_at_ = now;
    const NavigatedState& state = strapdown_.state();
    Measured& m = measured_;
    const double radius_m = state.p_MoB_M.norm();
    m.up_M = state.p_MoB_M / radius_m;
    m.altitude_m = radius_m - solution_.target_radius_m;
    m.speed_mps = state.v_MB_M.norm();
    const double climb_mps = state.v_MB_M.dot(m.up_M);
    m.descent_rate_mps = -climb_mps;
    m.level_velocity_M = state.v_MB_M - climb_mps * m.up_M;
    m.free_M_mps2 = free_acceleration(state.p_MoB_M, state.v_MB_M);
    if (load_.gravity_fraction != 0.0) m.free_M_mps2 += local_gravity(state.p_MoB_M, load_.gravity_fraction);
    const Vector3 ahead = state.v_MB_M / std::max(m.speed_mps, 1.0e-3);
    force_filter_.on(parameters(), state.q_MB * strapdown_.specific_force_B_mps2(), ahead, cycle_s);
    m.deceleration_mps2 = force_filter_.drag_mps2() - m.free_M_mps2.dot(ahead);
    if (mode() < Mode::free_fall) {
        const double area_m2 =
            mode() == Mode::parachute_descent ? parameters().parachute_drag_area_m2 : parameters().entry_drag_area_m2;
        m.dynamic_pressure_Pa = std::max(load_.entry_mass_kg * force_filter_.drag_mps2() / area_m2, 0.0);
    } else {
        m.dynamic_pressure_Pa = 0.0;
    }
    m.mach = m.speed_mps / speed_of_sound_mps(m.altitude_m);
    m.bank_rad = bank_of(state.q_MB, state.p_MoB_M, state.v_MB_M);
    m.target = target_geometry(state.p_MoB_M, state.v_MB_M, target_M_, solution_.target_radius_m);
}

// Under the parachute, while navigation is by IMU and radar.
void EdlGnc::feel_wind() {
    if (mode() != Mode::parachute_descent || !radar_filter_.locked() || reckoning_.silent_s() > 0.0) return;
    const NavigatedState& state = strapdown_.state();
    wind_.on(parameters(), measured_.up_M, state.v_MB_M, state.q_MB * strapdown_.specific_force_B_mps2());
}

// The only place where the mode changes, always by state_machines.csv.
bool EdlGnc::take(GncModeEvent event, Sclk now, Output& out, const std::optional<Condition>& because) {
    const Mode from = mode();
    if (!mode_machine_.take(event)) return false;
    mode_since_ = now;
    static_cast<void>(out.mode_changes.try_push_back({from, event, mode(), because}));
    return true;
}

bool EdlGnc::fire(Trigger trigger, const Conditions& conditions, Output& out) {
    AEOLIS_CHECK(static_cast<std::size_t>(trigger) < fired_.size());
    bool& done = fired_[static_cast<std::size_t>(trigger)];
    if (done || out.triggers.full()) return false;
    if (!all_hold(conditions)) {
        hold(trigger, conditions, out);
        return false;
    }
    done = true;
    out.triggers.push_back({trigger, conditions});
    return true;
}

void EdlGnc::hold(Trigger trigger, const Conditions& conditions, Output& out) const {
    if (fired(trigger) || !triggers::near(parameters(), conditions)) return;
    static_cast<void>(out.held.try_push_back({trigger, triggers::worth_telling(conditions)}));
}

void EdlGnc::cycle(const DeviceInputs& in, const Configuration& configuration, Output& out) {
    out = Output{};
    navigate(in.imu.span(), in.now);
    cruise_stage_gone_ = configuration.cruise_stage_gone;
    if (in.cruise_attitude) on(*in.cruise_attitude);
    take_cruise_attitude();
    if (!navigating_) {
        measured_at_ = in.now;
        return;
    }
    measure(in.now);
    if (configuration.radar_on) {
        radar_filter_.remember(in.now, measured_.altitude_m, strapdown_.state().v_MB_M);
        Conditions first;
        if (radar_first_)
            first.push_back(
                at_most(Quantity::radar_altitude_m, last_radar_altitude_m_, parameters().radar_altitude_max_m));
        fire(Trigger::radar_lock, first, out);
    }
    feel_wind();
    follow_configuration(configuration, in.now, out);
    decide_in_air(configuration, in.now, out);
    decide_on_engines(configuration, in.now, out);
    guide_entry(in.now, configuration, out);
    guide_descent(in.now, configuration, out);
    steer(configuration, out);
    burn(in, configuration);
    watch_devices(in, configuration, out);
    report(out);
}

// Mode changes that follow the timeline. Conditions that stay true are offered in each cycle; the table selects.
void EdlGnc::follow_configuration(const Configuration& configuration, Sclk now, Output& out) {
    using Event = GncModeEvent;
    if (configuration.enabled) take(Event::enabled, now, out);
    if (configuration.guidance_armed) take(Event::guidance_armed, now, out);
    const Condition straight = at_least(Quantity::time_in_mode_s, since(mode_since_), parameters().sufr_duration_s);
    if (straight.holds) take(Event::straightened_up, now, out, straight);
    if (configuration.parachute_out)
        take(Event::parachute_out, now, out);
    else
        take(Event::parachute_missing, now, out);
    if (configuration.backshell_gone && take(Event::backshell_gone, configuration.backshell_time.value_or(now), out))
        mass_kg_ = load_.powered_descent_mass_kg;
    if (configuration.sky_crane_started && take(Event::throttled_down, now, out)) rate_control_.start();
    if (configuration.touchdown_declared) take(Event::touchdown_declared, now, out);
    if (configuration.flyaway_started && take(Event::flyaway_started, now, out))
        mass_kg_ -= load_.rover_mass_kg;  // the bridle is cut before fly-away starts
}

// Entry and parachute: decisions from the navigated state.
void EdlGnc::decide_in_air(const Configuration& configuration, Sclk now, Output& out) {
    const Measured& m = measured_;
    const triggers::InAir in_air{m.speed_mps,           m.altitude_m, m.descent_rate_mps,
                                 m.dynamic_pressure_Pa, m.mach,       m.target.range_to_go_m};
    const triggers::ParachuteBounds parachute{solution_.parachute_speed_mps, solution_.parachute_altitude_min_m};
    const GncModeMachine& machine = mode_machine_;
    if (machine.can(GncModeEvent::drag_felt) &&
        fire(Trigger::guidance_start, triggers::guidance_start(parameters(), force_filter_.drag_mps2()), out))
        take(GncModeEvent::drag_felt, now, out);
    if (machine.can(GncModeEvent::slow_for_heading) &&
        fire(Trigger::heading_alignment, triggers::heading_alignment(parameters(), m.speed_mps), out))
        take(GncModeEvent::slow_for_heading, now, out);
    if (machine.can(GncModeEvent::parachute_near) && configuration.sufr_allowed &&
        fire(Trigger::sufr_start, triggers::sufr_start(parameters(), in_air, m.deceleration_mps2, parachute), out)) {
        bank_at_sufr_rad_ = m.bank_rad;
        take(GncModeEvent::parachute_near, now, out);
    }
    if (mode() >= Mode::range_control && mode() <= Mode::wait_for_parachute) {
        const auto held = due_for_parachute_.on(triggers::parachute_due(parameters(), in_air, parachute));
        fire(Trigger::parachute, triggers::parachute(parameters(), in_air, parachute, held), out);
    }
    if (mode() != Mode::parachute_descent) return;
    const double since_parachute_s = configuration.parachute_time ? now - *configuration.parachute_time : 0.0;
    if (!configuration.heatshield_gone)
        fire(Trigger::heatshield,
             triggers::heatshield(parameters(), in_air, solution_.heatshield_speed_mps, since_parachute_s), out);
    if (!configuration.heatshield_gone) return;
    // Inertial altitude alone may be kilometres off by now; it is used only after waiting for the radar in vain.
    const double since_heatshield_s = configuration.heatshield_time ? now - *configuration.heatshield_time : 0.0;
    auto priming =
        triggers::engine_priming(parameters(), m.altitude_m, m.descent_rate_mps, solution_.backshell_altitude_m);
    if (radar_filter_.locked() || since_heatshield_s >= parameters().radar_patience_s) {
        fire(Trigger::engine_priming, priming, out);
    } else {
        priming.push_back(is(Quantity::radar_locked, false));
        hold(Trigger::engine_priming, priming, out);
    }
    const triggers::BackshellBounds backshell{solution_.backshell_altitude_m, solution_.backshell_descent_rate_mps};
    const double needed_m = triggers::backshell_altitude_needed_m(parameters(), backshell, m.descent_rate_mps);
    const auto held = low_for_backshell_.on(m.altitude_m <= needed_m);
    if (configuration.engines_primed)
        fire(Trigger::backshell, triggers::backshell(parameters(), m.altitude_m, m.descent_rate_mps, backshell, held),
             out);
}

// Powered descent and sky crane.
void EdlGnc::decide_on_engines(const Configuration& configuration, Sclk now, Output& out) {
    using namespace powered_descent;
    const Measured& m = measured_;
    Conditions conditions;
    if (mode() == Mode::free_fall) {
        conditions.push_back(
            at_least(Quantity::time_since_backshell_s, since(mode_since_), parameters().powered_approach_delay_s));
        if (!fire(Trigger::powered_approach, conditions, out)) return;
        take(GncModeEvent::fallen_clear, now, out);
        approach_.start(parameters(), m.altitude_m, m.descent_rate_mps);
        const double duration_s =
            (m.descent_rate_mps - parameters().constant_velocity_mps) / approach_.deceleration_mps2();
        const Vector3& p_MoB_M = strapdown_.state().p_MoB_M;
        const Vector3 divert_M = load_.divert_m * azimuth_direction(p_MoB_M, load_.divert_azimuth_deg * degree);
        const auto sidestep =
            choose_sidestep(parameters(), divert_M, m.level_velocity_M, wind_.wind_M(parameters(), m.up_M), duration_s);
        out.sidestep = sidestep.conditions;
        divert_.start(sidestep.displacement_M, m.level_velocity_M, duration_s);
        divert_from_M_ = p_MoB_M;
    } else if (mode() == Mode::powered_approach) {
        if (fire(Trigger::constant_velocity,
                 triggers::constant_velocity(parameters(), m.altitude_m, m.descent_rate_mps), out))
            take(GncModeEvent::approached, now, out);
    } else if (mode() == Mode::constant_velocity) {
        conditions.push_back(at_most(Quantity::altitude_m, m.altitude_m,
                                     constant_deceleration_altitude_m(parameters(), m.descent_rate_mps)));
        if (!fire(Trigger::constant_deceleration, conditions, out)) return;
        take(GncModeEvent::low_enough, now, out);
        deceleration_.start(parameters(), m.altitude_m, m.descent_rate_mps);
    } else if (mode() == Mode::constant_deceleration) {
        conditions.push_back(
            at_most(Quantity::descent_rate_mps, m.descent_rate_mps,
                    parameters().sky_crane_descent_rate_mps + parameters().sky_crane_rate_tolerance_mps));
        fire(Trigger::sky_crane, conditions, out);
    } else if (mode() == Mode::sky_crane) {
        conditions.push_back(at_least(Quantity::time_in_mode_s, since(mode_since_), parameters().sky_crane_settle_s));
        fire(Trigger::rover_separation, conditions, out);
        if (configuration.rover_separated && configuration.touchdown_logic_ready)
            fire(Trigger::touchdown,
                 touchdown_logic_.on(parameters(), thrust_command_N_, mass_kg_, load_.rover_mass_kg), out);
    }
}

void EdlGnc::guide_entry(Sclk now, const Configuration& configuration, Output& out) {
    const Measured& m = measured_;
    AttitudeCommand& attitude = out.attitude;
    const double bank_before_guidance_rad = parameters().bank_before_guidance_deg * degree;
    if (mode() < Mode::wait_for_guidance_start) {
        if (mode() == Mode::approach && configuration.turning_to_entry) {
            bank_command_rad_ = bank_before_guidance_rad;
            attitude.mode = AttitudeCommand::Mode::entry_bank;
        } else if (mode() == Mode::approach) {
            attitude.mode = AttitudeCommand::Mode::detumble;
        }
    } else if (mode() == Mode::wait_for_guidance_start) {
        bank_command_rad_ = bank_before_guidance_rad;
        attitude.mode = AttitudeCommand::Mode::entry_bank;
    } else if (mode() == Mode::range_control) {
        attitude.mode = AttitudeCommand::Mode::entry_bank;
        RangeControlInput input;
        input.velocity_mps = m.speed_mps;
        input.drag_mps2 = force_filter_.drag_mps2();
        input.altitude_rate_mps = -m.descent_rate_mps;
        input.range_to_go_m = m.target.range_to_go_m;
        input.lift_to_drag = force_filter_.lift_to_drag(parameters(), load_.entry_lift_to_drag);
        const RangeControlOutput wanted = range_control(parameters(), load_.entry_reference, input);
        predicted_range_m_ = wanted.predicted_range_m;
        lift_to_drag_command_ = wanted.vertical_lift_to_drag;
        // Near full lift up the two sides hardly differ: a reversal then counts as settled.
        const Condition level = below(Quantity::bank_command_deg, wanted.bank_magnitude_rad / degree,
                                      parameters().reversal_settled_below_deg);
        const Condition on_its_side = lateral_.sign() > 0 ? above(Quantity::bank_deg, m.bank_rad / degree, 0.0)
                                                          : below(Quantity::bank_deg, m.bank_rad / degree, 0.0);
        const Conditions reversal = lateral_.on(parameters(), now, m.target.crossrange_m, m.speed_mps, wanted.saturated,
                                                level.holds ? level : on_its_side);
        if (all_hold(reversal)) out.bank_reversal = {lateral_.reversals(), reversal};
        if (now.ticks() % static_cast<std::int64_t>(parameters().height_guard_every_ticks) == 0)
            bank_allowed_rad_ =
                bank_allowed_rad(parameters(), altitude_when_slow_m(parameters(),
                                                                    {m.altitude_m, m.speed_mps, m.descent_rate_mps,
                                                                     input.drag_mps2, input.lift_to_drag},
                                                                    solution_.parachute_speed_mps));
        bank_command_rad_ = lateral_.sign() * std::min(wanted.bank_magnitude_rad, bank_allowed_rad_);
    } else if (mode() == Mode::heading_alignment) {
        attitude.mode = AttitudeCommand::Mode::entry_bank;
        bank_command_rad_ = heading_alignment_bank_rad(parameters(), m.target);
    } else if (mode() == Mode::straighten_up) {
        attitude.mode = AttitudeCommand::Mode::entry_bank;
        bank_command_rad_ = sufr::bank_rad(parameters(), now - mode_since_, bank_at_sufr_rad_);
    } else if (mode() == Mode::wait_for_parachute) {
        attitude.mode = AttitudeCommand::Mode::entry_bank;
        bank_command_rad_ = 0.0;
    } else if (mode() == Mode::parachute_descent) {
        attitude.mode = AttitudeCommand::Mode::suspended;
    }
    attitude.bank_rad = bank_command_rad_;
}

// Commands the thrust that accelerates the vehicle by `acceleration_M`.
void EdlGnc::push(const Vector3& acceleration_M, int engines, Output& out) {
    const powered_descent::Thrust thrust =
        powered_descent::allocate(parameters(), acceleration_M - measured_.free_M_mps2, measured_.up_M, mass_kg_,
                                  engines, load_.engine_max_thrust_N);
    thrust_command_N_ = thrust.magnitude_N;
    out.attitude.thrust_direction_M = to_array(thrust.direction_M);
    out.engines.throttle = thrust.throttle;
}

void EdlGnc::guide_descent(Sclk now, const Configuration& configuration, Output& out) {
    using namespace powered_descent;
    const Measured& m = measured_;
    if (mode() < Mode::free_fall) return;
    out.attitude.mode = AttitudeCommand::Mode::thrust;
    out.attitude.thrust_direction_M = to_array(m.up_M);
    out.engines.ignited = configuration.engines_ignited && !configuration.engines_off;
    thrust_command_N_ = 0.0;
    if (!out.engines.ignited) return;

    const Vector3& v_M = strapdown_.state().v_MB_M;
    const int engines = configuration.sky_crane_started ? 4 : 8;
    // Once the divert has ended, the remaining drift is nulled.
    const Vector3 null_drift = -parameters().descent_rate_gain_per_s * m.level_velocity_M;
    if (mode() == Mode::free_fall) {
        out.engines.throttle.fill(load_.engine_min_thrust_N / load_.engine_max_thrust_N);  // warm-up
        thrust_command_N_ = engine_count * load_.engine_min_thrust_N;
    } else if (mode() == Mode::powered_approach) {
        const Vector3 moved = strapdown_.state().p_MoB_M - divert_from_M_;
        const Vector3 level =
            divert_.command_M(parameters(), now - mode_since_, moved - moved.dot(m.up_M) * m.up_M, m.level_velocity_M);
        const double up = approach_.acceleration_mps2(parameters(), m.altitude_m, m.descent_rate_mps);
        push(level - level.dot(m.up_M) * m.up_M + up * m.up_M, engines, out);
    } else if (mode() == Mode::constant_velocity) {
        push(null_drift + hold_rate_mps2(parameters(), m.descent_rate_mps, parameters().constant_velocity_mps) * m.up_M,
             engines, out);
    } else if (mode() == Mode::constant_deceleration) {
        deceleration_.advance(parameters(), m.altitude_m, cycle_s);
        push(null_drift + deceleration_.acceleration_mps2(parameters(), m.descent_rate_mps) * m.up_M, engines, out);
    } else if (mode() == Mode::sky_crane || mode() == Mode::touchdown) {
        const double wanted_mps = mode() == Mode::sky_crane ? parameters().sky_crane_descent_rate_mps : 0.0;
        push(rate_control_.command_M(parameters(), v_M, m.up_M, wanted_mps, cycle_s), engines, out);
    } else if (mode() == Mode::flyaway) {
        const flyaway::Command wanted = flyaway::command(parameters(), now - mode_since_, strapdown_.state().p_MoB_M);
        const double thrust_N = wanted.full ? engines * parameters().engine_used_max_N : mass_kg_ * mars_weight_mps2;
        out.engines.throttle =
            throttles_for(parameters(), thrust_N, engines, load_.engine_max_thrust_N, thrust_command_N_);
        out.attitude.thrust_direction_M = to_array(wanted.direction_M);
    }
}

Steers steers(Mode mode, const Configuration& configuration, const EngineCommand& engines) {
    if (mode <= Mode::free_fall || !engines.ignited) return Steers::thrusters;
    return configuration.sky_crane_started ? Steers::four_engines : Steers::eight_engines;
}

Inertia inertia_of(Mode mode, const Configuration& configuration, double rigid_kg) {
    const Gyration& radii =
        mode < Mode::free_fall ? configuration.heatshield_gone ? gyration_without_heatshield : gyration_of_entry_vehicle
        : configuration.rover_separated ? gyration_of_stage
                                        : gyration_of_stage_with_rover;
    return {rigid_kg * radii.across_m * radii.across_m, rigid_kg * radii.along_z_m * radii.along_z_m};
}

HeldBy held_by(Mode mode, const EngineCommand& engines) {
    if (mode >= Mode::free_fall) return engines.ignited ? HeldBy::engines : HeldBy::nothing;
    if (mode == Mode::parachute_descent) return HeldBy::parachute;
    if (mode == Mode::straighten_up) return HeldBy::new_trim;
    return mode >= Mode::range_control ? HeldBy::air : HeldBy::nothing;
}

void EdlGnc::steer(const Configuration& configuration, Output& out) {
    const NavigatedState& state = strapdown_.state();
    const bool in_air = mode() >= Mode::range_control;
    const AttitudeState attitude{state.p_MoB_M, state.v_MB_M, state.q_MB, strapdown_.rate_B_rps(), in_air};
    const bool rover_hangs = configuration.rover_separated && mode() != Mode::flyaway;
    const double rigid_kg =
        mode() < Mode::free_fall ? load_.entry_mass_kg : mass_kg_ - (rover_hangs ? load_.rover_mass_kg : 0.0);
    const Inertia inertia = inertia_of(mode(), configuration, rigid_kg);
    steering_.cycle(parameters(), out.attitude, attitude, inertia, steers(mode(), configuration, out.engines),
                    out.thrusters, out.engines);
    surroundings_.held_by = held_by(mode(), out.engines);
    surroundings_.inertia = inertia;
    surroundings_.mass_kg = rigid_kg;
    surroundings_.thrust_N = thrust_felt_N_;
    // Thrusters rest while the parachute opens, until the heatshield is gone.
    const bool turned = mode() != Mode::parachute_descent || configuration.heatshield_gone;
    surroundings_.torque_B_Nm = turned ? steering_.torque_B_Nm() : Vector3(Vector3::Zero());
    if (out.thrusters != ThrusterCommand{})
        pulses_felt_until_ = measured_at_ + parameters().pulse_felt_ticks * seconds_per_tick;
}

void EdlGnc::burn(const DeviceInputs& in, const Configuration& configuration) {
    if (mode() < Mode::free_fall || configuration.engines_off) return;
    // Thrust reported by the engines; until they report any, the commanded thrust.
    thrust_felt_N_ = in.engines ? in.engines->thrust_N : thrust_command_N_;
    mass_kg_ -= thrust_felt_N_ / (load_.engine_isp_s * standard_gravity_mps2) * cycle_s;
}

void EdlGnc::watch_devices(const DeviceInputs& in, const Configuration& configuration, Output& out) {
    out.imu_heard = !in.imu.empty();
    out.engines_heard = in.engines.has_value();
    const bool awaited = configuration.engines_primed && !configuration.engines_off && !out.engines_heard;
    engines_silent_s_ = awaited ? engines_silent_s_ + cycle_s : 0.0;
    out.engines_silent_s = engines_silent_s_;
    const bool should_obey = mode() <= Mode::parachute_descent && configuration.thrusters_on_time &&
                             since(*configuration.thrusters_on_time) >= parameters().thrusters_judged_after_s;
    out.thrusters_judged = should_obey;
    if (!should_obey) return thruster_answer_.forget();
    out.thrusters_felt =
        thruster_answer_.feel(parameters(), out.imu_heard ? std::optional{strapdown_.rate_B_rps()} : std::nullopt);
    thruster_answer_.command(out.thrusters, surroundings_.inertia);
}

void EdlGnc::report(Output& out) const {
    const NavigatedState& state = strapdown_.state();
    const Measured& m = measured_;
    out.mode = mode();
    out.p_MoB_M_m = to_array(state.p_MoB_M);
    out.v_MB_M_mps = to_array(state.v_MB_M);
    out.q_MB = to_array(state.q_MB);
    out.altitude_m = m.altitude_m;
    out.speed_mps = m.speed_mps;
    out.descent_rate_mps = m.descent_rate_mps;
    out.horizontal_speed_mps = m.level_velocity_M.norm();
    out.flight_path_deg = std::atan2(-m.descent_rate_mps, out.horizontal_speed_mps) / degree;
    out.bank_deg = m.bank_rad / degree;
    out.angle_of_attack_deg = angle_of_attack(state.q_MB, state.v_MB_M) / degree;
    out.drag_mps2 = force_filter_.drag_mps2();
    out.range_to_go_m = m.target.range_to_go_m;
    out.crossrange_m = m.target.crossrange_m;
    out.predicted_range_m = predicted_range_m_;
    out.bank_command_deg = bank_command_rad_ / degree;
    out.lift_to_drag_command = lift_to_drag_command_;
    out.dynamic_pressure_Pa = m.dynamic_pressure_Pa;
    out.mach = m.mach;
    out.reversals = lateral_.reversals();
    out.acceleration_B_mps2 = to_array(strapdown_.specific_force_B_mps2());
    out.rate_B_rps = to_array(strapdown_.rate_B_rps());
    out.thrust_command_N = thrust_command_N_;
    const bool on_engines = mode() >= Mode::free_fall;
    out.mass_kg = on_engines ? mass_kg_ : load_.entry_mass_kg;
    const double carried_kg = load_.descent_stage_dry_kg + (mode() == Mode::flyaway ? 0.0 : load_.rover_mass_kg);
    out.propellant_kg = (on_engines ? mass_kg_ : load_.powered_descent_mass_kg) - carried_kg;
    out.propellant_low = mode() < Mode::flyaway && out.propellant_kg < parameters().propellant_low_kg;
    out.dead_reckoned_s = reckoning_.silent_s();
    out.attitude_uncertainty_deg = belief_.attitude_rad() / degree;
    out.velocity_uncertainty_mps = belief_.velocity_mps();
    out.altitude_uncertainty_m = belief_.altitude_m();
    out.radar_locked = radar_filter_.locked();
    out.radar_beams = last_radar_beams_;
}

}  // namespace aeolis::flight::gnc
