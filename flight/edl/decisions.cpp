// SPDX-License-Identifier: Apache-2.0
#include "flight/edl/decisions.hpp"

#include "flight/explanation/explanation.hpp"
#include "flight/gnc/mars.hpp"

#include <cmath>

namespace aeolis::flight {
namespace {

using gnc::standard_gravity_mps2;

template <typename Evr>
Evr at_state(const gnc::Output& gnc) {
    Evr evr;
    evr.altitude_m = single(gnc.altitude_m);
    evr.speed_mps = single(gnc.speed_mps);
    return evr;
}

void request_tone(Outbox& out, ToneId tone) {
    out.send(ModuleId::mfsk, ToneRequest{tone, out.now()});
}

template <typename Enumeration>
constexpr std::uint16_t number_of(Enumeration value) {
    return static_cast<std::uint16_t>(value);
}

}  // namespace

Decision decision_of(gnc::Trigger trigger) {
    switch (trigger) {
    case gnc::Trigger::guidance_start: return Decision::guidance_start;
    case gnc::Trigger::heading_alignment: return Decision::heading_alignment;
    case gnc::Trigger::sufr_start: return Decision::sufr_start;
    case gnc::Trigger::parachute: return Decision::parachute_deploy;
    case gnc::Trigger::heatshield: return Decision::heatshield;
    case gnc::Trigger::radar_lock: return Decision::radar_lock;
    case gnc::Trigger::engine_priming: return Decision::engine_priming;
    case gnc::Trigger::backshell: return Decision::backshell;
    case gnc::Trigger::powered_approach: return Decision::powered_approach;
    case gnc::Trigger::constant_velocity: return Decision::constant_velocity;
    case gnc::Trigger::constant_deceleration: return Decision::constant_deceleration;
    case gnc::Trigger::sky_crane: return Decision::sky_crane;
    case gnc::Trigger::rover_separation: return Decision::rover_separation;
    case gnc::Trigger::touchdown: return Decision::touchdown;
    }
    return Decision::gnc_mode;
}

std::optional<AnchorId> anchor_of(gnc::Trigger trigger) {
    switch (trigger) {
    case gnc::Trigger::guidance_start: return anchor::guidance_start;
    case gnc::Trigger::sufr_start: return anchor::sufr_start;
    case gnc::Trigger::parachute: return anchor::parachute;
    case gnc::Trigger::heatshield: return anchor::heatshield;
    case gnc::Trigger::engine_priming: return anchor::priming;
    case gnc::Trigger::backshell: return anchor::backshell;
    case gnc::Trigger::powered_approach: return anchor::powered_approach;
    case gnc::Trigger::sky_crane: return anchor::sky_crane;
    case gnc::Trigger::rover_separation: return anchor::rover_separation;
    case gnc::Trigger::touchdown: return anchor::touchdown;
    case gnc::Trigger::heading_alignment:
    case gnc::Trigger::radar_lock:
    case gnc::Trigger::constant_velocity:
    case gnc::Trigger::constant_deceleration: return std::nullopt;
    }
    return std::nullopt;
}

void announce(gnc::Trigger trigger, const gnc::Output& gnc, Outbox& out) {
    switch (trigger) {
    case gnc::Trigger::guidance_start: {
        auto evr = at_state<evr::GUIDANCE_START>(gnc);
        evr.drag_mps2 = single(gnc.drag_mps2);
        return out.event(evr);
    }
    case gnc::Trigger::heading_alignment:
        request_tone(out, tone::heading_alignment);
        return out.event(at_state<evr::HEADING_ALIGNMENT>(gnc));
    case gnc::Trigger::sufr_start: return out.event(at_state<evr::SUFR_START>(gnc));
    case gnc::Trigger::parachute: {
        auto evr = at_state<evr::PARACHUTE_DEPLOY>(gnc);
        evr.mach = single(gnc.mach);
        evr.dynamic_pressure_Pa = single(gnc.dynamic_pressure_Pa);
        return out.event(evr);
    }
    case gnc::Trigger::heatshield: return out.event(at_state<evr::HEATSHIELD_SEPARATION>(gnc));
    case gnc::Trigger::radar_lock:
        request_tone(out, tone::radar_lock);
        return out.event(evr::RADAR_LOCK{.radar_altitude_m = single(gnc.altitude_m), .beams = gnc.radar_beams});
    case gnc::Trigger::engine_priming: return out.event(at_state<evr::ENGINE_PRIMING>(gnc));
    case gnc::Trigger::backshell: return out.event(at_state<evr::BACKSHELL_SEPARATION>(gnc));
    case gnc::Trigger::powered_approach: return out.event(at_state<evr::POWERED_APPROACH_START>(gnc));
    case gnc::Trigger::constant_velocity:
        request_tone(out, tone::constant_velocity);
        return out.event(at_state<evr::CONSTANT_VELOCITY_START>(gnc));
    case gnc::Trigger::constant_deceleration:
        request_tone(out, tone::constant_deceleration);
        return out.event(at_state<evr::CONSTANT_DECELERATION_START>(gnc));
    case gnc::Trigger::sky_crane: {
        auto evr = at_state<evr::SKY_CRANE_START>(gnc);
        evr.propellant_kg = single(gnc.propellant_kg);
        return out.event(evr);
    }
    case gnc::Trigger::rover_separation: return out.event(at_state<evr::ROVER_SEPARATION>(gnc));
    case gnc::Trigger::touchdown:
        return out.event(evr::TOUCHDOWN{.descent_rate_mps = single(gnc.descent_rate_mps),
                                        .horizontal_speed_mps = single(gnc.horizontal_speed_mps),
                                        .propellant_kg = single(gnc.propellant_kg)});
    }
}

void announce_bank_reversal(const gnc::Output& gnc, Outbox& out) {
    const gnc::BankReversal& reversal = gnc.bank_reversal;
    auto evr = at_state<evr::BANK_REVERSAL>(gnc);
    evr.number = reversal.number;
    evr.bank_deg = single(gnc.bank_command_deg);
    out.event(evr);
    request_tone(out, tone::bank_reversal);
    out.record(
        explanation(Decision::bank_reversal, ExplanationVerdict::decided, reversal.number, reversal.conditions.span()));
}

void explain(const gnc::JudgedTrigger& fired, std::uint16_t suppressed, Outbox& out) {
    out.record(
        explanation(decision_of(fired.trigger), ExplanationVerdict::decided, 0, fired.conditions.span(), suppressed));
}

void explain(const gnc::ModeChange& change, Outbox& out) {
    gnc::Conditions conditions;
    conditions.push_back(names(Quantity::previous_mode, number_of(change.from)));
    conditions.push_back(names(Quantity::mode_event, number_of(change.event)));
    if (change.because) conditions.push_back(*change.because);
    out.record(explanation(Decision::gnc_mode, ExplanationVerdict::changed, number_of(change.to), conditions.span()));
}

void explain(const gnc::RadarDecision& decision, Outbox& out) {
    out.record(explanation(Decision::radar_solution,
                           decision.believed ? ExplanationVerdict::believed : ExplanationVerdict::refused, 0,
                           decision.conditions.span()));
}

void explain(const PhaseChange& change, MaybeTime entry, Outbox& out) {
    gnc::Conditions conditions;
    conditions.push_back(names(Quantity::previous_phase, number_of(change.from)));
    conditions.push_back(names(Quantity::phase_event, number_of(change.event)));
    if (entry.defined()) {
        const double to_entry_s = *entry.get() - out.now();
        if (change.event == EdlPhaseEvent::late_cruise_begins)
            conditions.push_back(
                at_most(Quantity::time_to_uplinked_entry_s, to_entry_s, build_parameters.late_cruise_before_entry_s));
        if (change.event == EdlPhaseEvent::entry_moves_away)
            conditions.push_back(
                above(Quantity::time_to_uplinked_entry_s, to_entry_s, build_parameters.late_cruise_before_entry_s));
    }
    out.record(explanation(Decision::edl_phase, ExplanationVerdict::changed, number_of(change.to), conditions.span()));
}

void explain_held(const gnc::Output& gnc, HeldExplanations& held, Outbox& out) {
    for (const gnc::JudgedTrigger& one : gnc.held) held.held(decision_of(one.trigger), 0, one.conditions.span(), out);
}

void explain_held(const Parameters& parameters, const Timeline& timeline, HeldExplanations& held, Outbox& out) {
    const double worth_telling_after_s = parameters.held_worth_telling_after_s;
    const Sclk now = out.now();
    FixedVector<gnc::Condition, 2> conditions;
    if (const auto waiting = timeline.waiting(); waiting && now - waiting->triggered >= worth_telling_after_s) {
        conditions.push_back(at_least(Quantity::reply_wait_s, now - waiting->triggered, waiting->timeout_s));
    } else if (const TimepointId current = timeline.current();
               !waiting && !timeline.finished() && !timeline.rows()[current.value].may_be_late &&
               now >= timeline.next_desired() + MaybeOffset{worth_telling_after_s} &&
               timeline.next_minimum().defined() && !(now >= timeline.next_minimum())) {
        const double since_previous_s = now - *timeline.previous_fired().get();
        const double minimum_s = *timeline.next_minimum().get() - *timeline.previous_fired().get();
        conditions.push_back(at_least(Quantity::time_since_previous_timepoint_s, since_previous_s, minimum_s));
        conditions.push_back(
            at_least(Quantity::time_overdue_s, now - *timeline.next_desired().get(), worth_telling_after_s));
    }
    if (!conditions.empty()) held.held(Decision::timepoint, timeline.current().value, conditions.span(), out);
}

void PeakDeceleration::watch(const Parameters& parameters, const gnc::Output& gnc, Outbox& out) {
    const double real_above_mps2 = parameters.peak_deceleration_min_g * standard_gravity_mps2;
    if (passed_ || gnc.mode < gnc::Mode::range_control || gnc.mode > gnc::Mode::wait_for_parachute) return;
    const auto& a = gnc.acceleration_B_mps2;
    const double sensed_mps2 = std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    if (sensed_mps2 > largest_mps2_) {
        largest_mps2_ = sensed_mps2;
        altitude_m_ = gnc.altitude_m;
        speed_mps_ = gnc.speed_mps;
    } else if (largest_mps2_ > real_above_mps2 && sensed_mps2 < parameters.peak_deceleration_passed * largest_mps2_) {
        passed_ = true;
        out.event(evr::PEAK_DECELERATION{.deceleration_g = single(largest_mps2_ / standard_gravity_mps2),
                                         .altitude_m = single(altitude_m_),
                                         .speed_mps = single(speed_mps_)});
        request_tone(out, tone::peak_deceleration);
    }
}

}  // namespace aeolis::flight
