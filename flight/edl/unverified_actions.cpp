// SPDX-License-Identifier: Apache-2.0
#include "flight/edl/unverified_actions.hpp"

#include "flight/explanation/explanation.hpp"
#include "flight/timeline/actions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

namespace aeolis::flight {
namespace {

const TimepointSpec& row_of(const Firing& firing) {
    return timeline_specs[firing.timepoint.value];
}

bool is_pyro(const Firing& firing) {
    return firing.asked.kind == ReplyKind::pyro;
}

void tell_refused(const Firing& firing, Outbox& out) {
    out.event(evr::TIMEPOINT_REFUSED{.timepoint = firing.timepoint.value});
    out.send(ModuleId::mfsk, ToneRequest{is_pyro(firing) ? tone::pyro_refused : tone::action_refused, out.now()});
}

/// What was taken as done after the time-out no longer is.
void explain_late_refusal(const Firing& firing, Outbox& out) {
    const bool as_done = row_of(firing).if_unverified != IfUnverified::not_done;
    const std::array conditions{
        above(Quantity::reply_wait_s, out.now() - firing.triggered, row_of(firing).reply_timeout_s.value_or(0.0)),
        is(Quantity::taken_as_done, as_done, as_done)};
    out.record(explanation(Decision::timepoint, ExplanationVerdict::refused, firing.timepoint.value, conditions));
}

double magnitude(const std::array<double, 3>& v) {
    return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

}  // namespace

void tell_reply(const Firing& firing, const TimepointSpec& row, Outbox& out) {
    const double waited_s = firing.fired - firing.triggered;
    const double timeout_s = row.reply_timeout_s.value_or(0.0);
    switch (firing.verdict) {
    case FiringVerdict::completed:
    case FiringVerdict::no_operation: return;
    case FiringVerdict::verified:
        return out.event(evr::TIMEPOINT_VERIFIED{.timepoint = firing.timepoint.value, .reply_wait_s = waited_s});
    case FiringVerdict::refused: {
        tell_refused(firing, out);
        const gnc::Condition in_time = at_most(Quantity::reply_wait_s, waited_s, timeout_s);
        return out.record(
            explanation(Decision::timepoint, ExplanationVerdict::refused, firing.timepoint.value, {&in_time, 1}));
    }
    case FiringVerdict::unverified: {
        const bool as_done = row.if_unverified != IfUnverified::not_done;
        out.event(evr::TIMEPOINT_UNVERIFIED{.timepoint = firing.timepoint.value, .taken_as_done = as_done});
        out.send(ModuleId::mfsk, ToneRequest{tone::action_unverified, out.now()});
        const std::array conditions{at_least(Quantity::reply_wait_s, waited_s, timeout_s),
                                    is(Quantity::taken_as_done, as_done, as_done)};
        out.record(
            explanation(Decision::timepoint, ExplanationVerdict::unverified, firing.timepoint.value, conditions));
        return;
    }
    }
}

UnverifiedActions::By UnverifiedActions::witness_of(const Firing& firing) {
    switch (firing.fact) {
    case gnc::Fact::parachute_out: return By::imu_load;
    case gnc::Fact::heatshield_gone: return By::radar;
    case gnc::Fact::engines_primed: return By::engines;
    case gnc::Fact::backshell_gone: return By::imu_free_fall;
    case gnc::Fact::rover_separated: return By::bridle;
    case gnc::Fact::none:
    case gnc::Fact::pyros_armed:
    case gnc::Fact::pyros_safe:
    case gnc::Fact::thrusters_on:
    case gnc::Fact::cruise_stage_gone:
    case gnc::Fact::bridle_cut: return By::nothing;
    }
    return By::nothing;
}

void UnverifiedActions::miss_some() {
    for (Followed& followed : kept_) {
        followed.unheard = true;
        followed.cycles = 0;
    }
}

void UnverifiedActions::add(const Firing& firing) {
    if (firing.verdict == FiringVerdict::completed || firing.verdict == FiringVerdict::no_operation) return;
    By by = witness_of(firing);
    // What was verified only the IMU may contradict, and only where the sheet says so.
    if (firing.verdict == FiringVerdict::verified && row_of(firing).if_unverified != IfUnverified::done_unless_imu)
        by = By::nothing;
    if (by == By::nothing && firing.verdict == FiringVerdict::verified) return;
    if (kept_.full()) kept_.erase_at(0);
    kept_.push_back({.firing = firing, .by = by, .before_mps2 = felt_before_mps2_});
}

bool UnverifiedActions::on(const ActionReply& reply, ActionContext& context) {
    if (reply.evidence == Evidence::none) return false;
    // Of actions that asked for the same, it answers the newest.
    std::size_t behind = kept_.size();
    const auto is_answered = [&](const Firing& firing) {
        return firing.verdict != FiringVerdict::verified && reply.answers(firing.asked);
    };
    while (behind > 0 && !is_answered(kept_[behind - 1].firing)) --behind;
    if (behind == 0) return false;
    Followed& followed = kept_[behind - 1];
    const Firing& firing = followed.firing;
    if (reply.evidence == Evidence::refused && firing.verdict == FiringVerdict::refused && !followed.borne_out)
        return false;  // told already
    if (reply.evidence == Evidence::verified) {
        context.out().event(evr::TIMEPOINT_VERIFIED_LATE{.timepoint = firing.timepoint.value,
                                                         .reply_wait_s = context.now() - firing.triggered});
        context.configuration().learn(firing.fact, firing.triggered);
        if (!followed.borne_out) context.announce(row_of(firing));
        kept_.erase_at(behind - 1);
    } else if (followed.borne_out) {
        context.out().event(evr::REPLY_CONTRADICTS{.device = static_cast<DeviceName>(Device::pyro)});
        kept_.erase_at(behind - 1);
    } else {
        tell_refused(firing, context.out());
        explain_late_refusal(firing, context.out());
        context.configuration().forget(firing.fact);
        followed.firing.verdict = FiringVerdict::refused;  // a witness or a later reply may still know better
    }
    return true;
}

/// What the witness says in this cycle; none: nothing yet.
std::optional<gnc::Condition> UnverifiedActions::said(const Followed& followed, const Parameters& parameters,
                                                      const gnc::Output& gnc, double bridle_m) {
    switch (followed.by) {
    case By::radar: return is(Quantity::radar_locked, gnc.radar_locked);
    case By::engines: return is(Quantity::engines_heard, gnc.engines_heard);
    case By::bridle: return at_least(Quantity::bridle_m, bridle_m, parameters.bridle_felt_m);
    case By::imu_free_fall:
        if (!gnc.imu_heard || gnc.mode > gnc::Mode::free_fall) return std::nullopt;  // engines push from then on
        return at_most(Quantity::sensed_mps2, magnitude(gnc.acceleration_B_mps2), parameters.free_fall_felt_mps2);
    case By::imu_load:
        if (!gnc.imu_heard) return std::nullopt;
        return at_least(Quantity::sensed_mps2, magnitude(gnc.acceleration_B_mps2), parameters.parachute_felt_mps2);
    case By::nothing: return std::nullopt;
    }
    return std::nullopt;
}

void UnverifiedActions::bear_out(Followed& followed, std::span<const gnc::Condition> conditions,
                                 gnc::Configuration& configuration, Outbox& out) {
    const Firing& firing = followed.firing;
    const By by = std::exchange(followed.by, By::nothing);
    followed.borne_out = true;
    if (firing.verdict == FiringVerdict::verified) return;
    if (by == By::imu_load)
        out.event(evr::TIMEPOINT_FELT{.timepoint = firing.timepoint.value, .felt_mps2 = single(followed.felt_mps2)});
    else
        out.event(evr::TIMEPOINT_WITNESSED{.timepoint = firing.timepoint.value,
                                           .witness = by == By::radar     ? Witness::radar
                                                      : by == By::engines ? Witness::engines
                                                      : by == By::bridle  ? Witness::bridle
                                                                          : Witness::imu});
    out.record(explanation(Decision::timepoint, ExplanationVerdict::borne_out, firing.timepoint.value, conditions));
    configuration.learn(firing.fact, firing.triggered);
    ActionContext{out, configuration}.announce(row_of(firing));
}

void UnverifiedActions::contradict(Followed& followed, std::span<const gnc::Condition> conditions,
                                   gnc::Configuration& configuration, Outbox& out) {
    const Firing& firing = followed.firing;
    followed.by = By::nothing;
    if (followed.unheard || firing.verdict == FiringVerdict::refused) return;
    if (firing.verdict == FiringVerdict::unverified) configuration.forget(firing.fact);
    out.event(
        evr::TIMEPOINT_CONTRADICTED{.timepoint = firing.timepoint.value, .felt_mps2 = single(followed.felt_mps2)});
    out.send(ModuleId::mfsk, ToneRequest{tone::action_contradicted, out.now()});
    out.record(explanation(Decision::timepoint, ExplanationVerdict::contradicted, firing.timepoint.value, conditions));
}

void UnverifiedActions::watch(const Parameters& parameters, const gnc::Output& gnc, double bridle_m,
                              gnc::Configuration& configuration, Outbox& out) {
    for (Followed& followed : kept_) {
        if (followed.by == By::nothing) continue;
        const bool by_imu = followed.by == By::imu_load || followed.by == By::imu_free_fall;
        if (followed.by == By::imu_load && followed.before_mps2 >= parameters.parachute_felt_mps2) {
            followed.by = By::nothing;
            continue;
        }
        followed.unheard = followed.unheard || gnc.dead_reckoned_s >= parameters.imu_silence_told_s;
        const auto told = said(followed, parameters, gnc, bridle_m);
        if (!told) continue;
        if (by_imu) followed.felt_mps2 = std::max(followed.felt_mps2, told->value);
        followed.cycles = told->holds ? static_cast<std::uint16_t>(followed.cycles + 1) : std::uint16_t{0};
        const auto lasts =
            at_least(Quantity::cycles_true, followed.cycles, by_imu ? std::floor(parameters.action_felt_cycles) : 1.0);
        const auto waited =
            at_least(Quantity::elapsed_s, out.now() - followed.firing.triggered, parameters.parachute_felt_within_s);
        const std::array conditions{*told, lasts};
        if (lasts.holds)  // a witness that is believed at once has no cycles to count
            bear_out(followed, std::span{conditions}.first(by_imu ? 2 : 1), configuration, out);
        else if (followed.by == By::imu_load && waited.holds && followed.cycles == 0)
            contradict(followed, std::array{*told, lasts, waited}, configuration, out);
    }
    if (gnc.imu_heard) felt_before_mps2_ = magnitude(gnc.acceleration_B_mps2);
}

}  // namespace aeolis::flight
