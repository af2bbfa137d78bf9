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
    if (kept_.full()) kept_.erase_at(0);
    kept_.push_back({firing, row_of(firing).if_unverified == IfUnverified::done_unless_imu, false, 0.0});
}

bool UnverifiedActions::on(const ActionReply& reply, ActionContext& context) {
    if (reply.evidence == Evidence::none) return false;
    const auto found = std::ranges::find_if(
        kept_, [&](const Unverified& unverified) { return reply.answers(unverified.firing.asked); });
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

void UnverifiedActions::watch(const Parameters& parameters, const gnc::Output& gnc, gnc::Configuration& configuration,
                              Outbox& out) {
    for (Unverified& unverified : kept_) {
        if (!unverified.by_imu) continue;
        const Firing& firing = unverified.firing;
        unverified.unheard = unverified.unheard || gnc.dead_reckoned_s >= parameters.imu_silence_told_s;
        if (gnc.dead_reckoned_s > 0.0) continue;
        unverified.felt_mps2 = std::max(unverified.felt_mps2, magnitude(gnc.acceleration_B_mps2));
        const auto felt = at_least(Quantity::sensed_mps2, unverified.felt_mps2, parameters.parachute_felt_mps2);
        if (felt.holds) {
            unverified.by_imu = false;
            out.event(evr::TIMEPOINT_FELT{.timepoint = firing.timepoint.value, .felt_mps2 = single(felt.value)});
            continue;
        }
        const auto waited =
            at_least(Quantity::elapsed_s, out.now() - firing.triggered, parameters.parachute_felt_within_s);
        if (!waited.holds) continue;
        unverified.by_imu = false;
        if (unverified.unheard) continue;
        configuration.forget(firing.fact);
        out.event(evr::TIMEPOINT_CONTRADICTED{.timepoint = firing.timepoint.value, .felt_mps2 = single(felt.value)});
        out.send(ModuleId::mfsk, ToneRequest{tone::pyro_not_fired, out.now()});
        const std::array conditions{felt, waited};
        out.record(
            explanation(Decision::timepoint, ExplanationVerdict::contradicted, firing.timepoint.value, conditions));
    }
}

}  // namespace aeolis::flight
