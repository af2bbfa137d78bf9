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
    while (!finished()) {
        if (waiting_) {
            const bool timed_out = now >= timeline::latest_firing(triggered_, rows_[current_].reply_timeout_s);
            if (!replied_ && !timed_out) return;
            complete(now, replied_ ? FiringVerdict::replied : FiringVerdict::timed_out, firings);
            continue;
        }
        if (fired_in_cycle_ == timeline::triggered_per_cycle_max || !current_due().have_come(now)) return;
        const auto& row = rows_[current_];

        ++fired_in_cycle_;
        triggered_ = now;
        if (!runs(row)) {
            complete(now, FiringVerdict::no_operation, firings);
            continue;
        }
        context.begin(row);
        if (row.event) row.event(context);
        if (row.action) row.action(context);
        if (row.tone) context.request_tone(*row.tone);
        if (row.reply_timeout_s) {
            awaited_ = context.awaited();
            waiting_ = true;
            return;
        }
        complete(now, row.action ? FiringVerdict::completed : FiringVerdict::no_operation, firings);
    }
}

timeline::Offsets Timeline::offsets(std::size_t row) const {
    return {rows_[row].anchor, desired_offset_s_[row], minimum_offset_s_[row]};
}

timeline::DueTimes Timeline::current_due() const {
    const auto& anchor = rows_[current_].anchor;
    return timeline::due_times(offsets(current_), previous_fired_, anchor ? anchor_times_[anchor->value] : MaybeTime{});
}

bool Timeline::limited(Sclk now) const {
    return fired_in_cycle_ == timeline::triggered_per_cycle_max && !finished() && !waiting_ &&
           current_due().have_come(now);
}

void Timeline::complete(Sclk now, FiringVerdict verdict, Firings& firings) {
    firings.push_back({current(), triggered_, now, verdict});
    previous_fired_ = now;
    waiting_ = replied_ = false;
    ++current_;
}

void Timeline::reply(const ActionReply& reply) {
    if (waiting_ && reply == awaited_) replied_ = true;
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
