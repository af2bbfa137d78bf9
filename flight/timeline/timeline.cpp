// SPDX-License-Identifier: Apache-2.0
#include "flight/timeline/timeline.hpp"

#include "flight/timeline/actions.hpp"

namespace aeolis::flight {

Timeline::Timeline(std::span<const TimepointSpec> rows, std::span<const AnchorSpec> anchors, bool essential_only)
    : rows_(rows), anchors_(anchors), essential_only_(essential_only) {
    AEOLIS_CHECK(rows.size() <= timeline_rows_max && anchors.size() <= anchors_max);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        desired_offset_s_[i] = rows[i].desired_offset_s;
        minimum_offset_s_[i] = rows[i].minimum_offset_s;
    }
    for (std::size_t i = 0; i < anchors.size(); ++i) anchor_offset_s_[i] = anchors[i].offset_s;
    compute_anchors();
}

void Timeline::begin(Sclk do_edl_accepted) {
    previous_fired_ = do_edl_accepted;
    begun_ = true;
}

void Timeline::compute_anchors() {
    for (std::size_t i = 0; i < anchors_.size(); ++i) {
        const auto& parent = anchors_[i].parent;
        anchor_times_[i] =
            parent ? timeline::anchor_time(anchor_times_[parent->value], anchor_offset_s_[i]) : MaybeTime{Sclk{0.0}};
    }
}

void Timeline::pass(Sclk now, ActionContext& context, Firings& firings) {
    compute_anchors();
    if (!begun_) return;
    // One that waited, as many as may be triggered, and a look at the next.
    constexpr std::size_t turns_max = timeline::triggered_per_cycle_max + 2;
    for (std::size_t turn = 0; turn < turns_max && !finished(); ++turn) {
        if (waiting_) {
            await_reply(now, context, firings);
            if (waiting_) return;
            continue;
        }
        if (fired_in_cycle_ == timeline::triggered_per_cycle_max || !current_due().have_come(now)) return;
        const auto& row = rows_[current_];

        ++fired_in_cycle_;
        triggered_ = now;
        if (!runs(row)) {
            awaited_ = {};
            fact_ = gnc::Fact::none;
            complete(now, FiringVerdict::no_operation, context, firings);
            continue;
        }
        command(now, context);
        if (row.reply_timeout_s) {
            waiting_ = true;
            context.out().event(evr::TIMEPOINT_COMMANDED{.timepoint = current().value});
            return;
        }
        context.announce(row);
        complete(now, row.action ? FiringVerdict::completed : FiringVerdict::no_operation, context, firings);
    }
}

void Timeline::command(Sclk now, ActionContext& context) {
    const auto& row = rows_[current_];
    commanded_ = now;
    context.begin(row);
    if (row.action) row.action(context);
    awaited_ = context.awaited();
    awaited_.evidence = Evidence::none;
    fact_ = context.fact();
}

// A verified timepoint fires at once. Any other is judged at its time-out: until then the device may still act.
void Timeline::await_reply(Sclk now, ActionContext& context, Firings& firings) {
    const auto& row = rows_[current_];
    if (awaited_.evidence == Evidence::verified) {
        context.announce(row);
        return complete(now, FiringVerdict::verified, context, firings);
    }
    if (now >= timeline::latest_firing(triggered_, row.reply_timeout_s)) {
        const bool refused = awaited_.evidence == Evidence::refused;
        return complete(now, refused ? FiringVerdict::refused : FiringVerdict::unverified, context, firings);
    }
    if (row.hold_repeat_s && now >= commanded_ + *row.hold_repeat_s) {
        command(now, context);
        context.out().event(evr::TIMEPOINT_HELD{.timepoint = current().value});
        context.request_tone(tone::action_held);
    }
}

timeline::Offsets Timeline::offsets(std::size_t row) const {
    return {rows_[row].anchor, desired_offset_s_[row], minimum_offset_s_[row], rows_[row].may_be_late};
}

timeline::DueTimes Timeline::current_due() const {
    const auto& anchor = rows_[current_].anchor;
    return timeline::due_times(offsets(current_), previous_fired_, anchor ? anchor_times_[anchor->value] : MaybeTime{});
}

bool Timeline::limited(Sclk now) const {
    return fired_in_cycle_ == timeline::triggered_per_cycle_max && !finished() && !waiting_ &&
           current_due().have_come(now);
}

void Timeline::complete(Sclk now, FiringVerdict verdict, ActionContext& context, Firings& firings) {
    const bool done = verdict == FiringVerdict::verified || verdict == FiringVerdict::completed;
    const bool taken_as_done =
        verdict == FiringVerdict::unverified && rows_[current_].if_unverified != IfUnverified::not_done;
    if (done || taken_as_done) context.configuration().learn(fact_, triggered_);
    firings.push_back({current(), triggered_, now, verdict, awaited_, fact_});
    previous_fired_ = now;
    waiting_ = false;
    ++current_;
}

bool Timeline::reply(const ActionReply& reply) {
    if (!waiting_ || !reply.answers(awaited_)) return false;
    if (awaited_.evidence != Evidence::verified) awaited_.evidence = reply.evidence;
    return true;
}

bool Timeline::set_timepoint_offsets(TimepointId id, MaybeOffset desired_s, MaybeOffset minimum_s) {
    if (id.value >= rows_.size()) return false;
    desired_offset_s_[id.value] = desired_s;
    minimum_offset_s_[id.value] = minimum_s;
    return true;
}

bool Timeline::set_anchor_offset(AnchorId id, MaybeOffset offset_s) {
    if (id.value >= anchors_.size() || !anchors_[id.value].parent) return false;
    anchor_offset_s_[id.value] = offset_s;
    return true;
}

void Timeline::set_anchor_now(AnchorId id, Sclk now) {
    AEOLIS_CHECK(id.value < anchors_.size() && anchors_[id.value].parent);
    const auto& parent = anchor_times_[anchors_[id.value].parent->value].get();
    AEOLIS_CHECK(parent.has_value());
    anchor_offset_s_[id.value] = now - *parent;
}

std::optional<Timeline::Waiting> Timeline::waiting() const {
    if (!waiting_) return std::nullopt;
    return Waiting{triggered_, *rows_[current_].reply_timeout_s};
}

bool Timeline::triggered(TimepointId id) const {
    return current_ > id.value || (current_ == id.value && waiting_);
}

MaybeTime Timeline::next_desired() const {
    return finished() ? MaybeTime{} : current_due().desired;
}

MaybeTime Timeline::next_minimum() const {
    return finished() ? MaybeTime{} : current_due().minimum;
}

MaybeTime Timeline::first_desired() const {
    return timeline::latest_begin(
        rows_.size(), [&](std::size_t row) { return offsets(row); },
        [&](std::size_t row) { return rows_[row].reply_timeout_s; },
        [&](AnchorId anchor) { return anchor_times_[anchor.value]; });
}

bool Timeline::backtrack(Sclk now) {
    await_nothing();
    previous_fired_ = now;
    if (finished() || !rows_[current_].backtrack || *rows_[current_].backtrack == current()) return false;
    current_ = rows_[current_].backtrack->value;
    return true;
}

TimepointState Timeline::state() const {
    if (finished()) return TimepointState::complete;
    if (waiting_) return TimepointState::waiting_reply;
    return next_desired().defined() ? TimepointState::pending : TimepointState::undefined;
}

}  // namespace aeolis::flight
