// SPDX-License-Identifier: Apache-2.0
#include "flight/edl/unverified_actions.hpp"

#include "flight/explanation/explanation.hpp"
#include "flight/timeline/actions.hpp"

#include <algorithm>
#include <cmath>

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
    out.send(ModuleId::mfsk, ToneRequest{is_pyro(firing) ? tone::pyro_not_fired : tone::action_refused, out.now()});
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

void UnverifiedActions::add(const Firing& firing) {
    const bool awaited = firing.verdict != FiringVerdict::completed && firing.verdict != FiringVerdict::no_operation;
    const bool by_imu = awaited && row_of(firing).if_unverified == IfUnverified::done_unless_imu;
    if (!by_imu && firing.verdict != FiringVerdict::unverified) return;
    if (kept_.full()) kept_.erase_at(0);
    kept_.push_back({firing, by_imu, false, 0.0});
}

bool UnverifiedActions::on(const ActionReply& reply, ActionContext& context) {
    if (reply.evidence == Evidence::none) return false;
    const auto found = std::ranges::find_if(kept_, [&](const Followed& followed) {
        return followed.firing.verdict == FiringVerdict::unverified && reply.answers(followed.firing.asked);
    });
    if (found == kept_.end()) return false;
    const Firing firing = found->firing;
    kept_.erase_at(static_cast<std::size_t>(found - kept_.begin()));
    if (reply.evidence == Evidence::verified) {
        context.out().event(evr::TIMEPOINT_VERIFIED_LATE{.timepoint = firing.timepoint.value,
                                                         .reply_wait_s = context.now() - firing.triggered});
        context.configuration().learn(firing.fact, firing.triggered);
        context.announce(row_of(firing));
    } else {
        tell_refused(firing, context.out());
        explain_late_refusal(firing, context.out());
        context.configuration().forget(firing.fact);
    }
    return true;
}

void UnverifiedActions::tell_felt(const Followed& followed, gnc::Configuration& configuration, Outbox& out) {
    const Firing& firing = followed.firing;
    if (firing.verdict == FiringVerdict::verified) return;
    out.event(evr::TIMEPOINT_FELT{.timepoint = firing.timepoint.value, .felt_mps2 = single(followed.felt_mps2)});
    if (firing.verdict != FiringVerdict::refused) return;
    configuration.learn(firing.fact, firing.triggered);
    ActionContext{out, configuration}.announce(row_of(firing));
}

void UnverifiedActions::tell_not_felt(const Followed& followed, std::span<const gnc::Condition> conditions,
                                      gnc::Configuration& configuration, Outbox& out) {
    const Firing& firing = followed.firing;
    if (followed.unheard || firing.verdict == FiringVerdict::refused) return;
    if (firing.verdict == FiringVerdict::unverified) configuration.forget(firing.fact);
    out.event(
        evr::TIMEPOINT_CONTRADICTED{.timepoint = firing.timepoint.value, .felt_mps2 = single(followed.felt_mps2)});
    out.send(ModuleId::mfsk, ToneRequest{tone::pyro_not_fired, out.now()});
    out.record(explanation(Decision::timepoint, ExplanationVerdict::contradicted, firing.timepoint.value, conditions));
}

void UnverifiedActions::watch(const Parameters& parameters, const gnc::Output& gnc, gnc::Configuration& configuration,
                              Outbox& out) {
    for (Followed& followed : kept_) {
        if (!followed.by_imu) continue;
        followed.unheard = followed.unheard || gnc.dead_reckoned_s >= parameters.imu_silence_told_s;
        if (gnc.dead_reckoned_s > 0.0) continue;
        followed.felt_mps2 = std::max(followed.felt_mps2, magnitude(gnc.acceleration_B_mps2));
        const auto felt = at_least(Quantity::sensed_mps2, followed.felt_mps2, parameters.parachute_felt_mps2);
        const auto waited =
            at_least(Quantity::elapsed_s, out.now() - followed.firing.triggered, parameters.parachute_felt_within_s);
        if (!felt.holds && !waited.holds) continue;
        followed.by_imu = false;
        if (felt.holds)
            tell_felt(followed, configuration, out);
        else
            tell_not_felt(followed, std::array{felt, waited}, configuration, out);
    }
}

}  // namespace aeolis::flight
