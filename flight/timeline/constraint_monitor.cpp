// SPDX-License-Identifier: Apache-2.0
#include "flight/timeline/constraint_monitor.hpp"

namespace aeolis::flight {
namespace {

constexpr std::size_t reports_per_cycle_max = 4;  // three messages each, of the 48 that an outbox holds

packet::Explanation explanation(std::uint16_t number, const ConstraintSpec& row, double elapsed_s) {
    packet::Explanation e{
        .decision = Decision::sub_constraint, .verdict = ExplanationVerdict::violated, .subject = number};
    if (row.minimum_s) {
        e.condition_count = 1;
        e.condition_1 = Quantity::elapsed_s;
        e.value_1 = elapsed_s;
        e.comparison_1 = Comparison::ge;
        e.bound_1 = *row.minimum_s;
        e.holds_1 = !timeline::bounds_of(row).too_soon(elapsed_s);
    }
    if (!row.maximum_s) return e;
    const bool holds = !timeline::bounds_of(row).too_late(elapsed_s);
    if (++e.condition_count == 1) {
        e.condition_1 = Quantity::elapsed_s;
        e.value_1 = elapsed_s;
        e.comparison_1 = Comparison::le;
        e.bound_1 = *row.maximum_s;
        e.holds_1 = holds;
    } else {
        e.condition_2 = Quantity::elapsed_s;
        e.value_2 = elapsed_s;
        e.comparison_2 = Comparison::le;
        e.bound_2 = *row.maximum_s;
        e.holds_2 = holds;
    }
    return e;
}

}  // namespace

ConstraintMonitor::ConstraintMonitor(std::span<const ConstraintSpec> rows) : rows_(rows) {
    AEOLIS_CHECK(rows.size() <= constraint_rows_max);
}

void ConstraintMonitor::watch(const Timeline& timeline, std::span<const Firing> firings) {
    for (std::size_t i = 0; i < anchor_count; ++i) {
        const AnchorId id{static_cast<std::uint16_t>(i)};
        note(Moment::of_anchor(id), timeline.anchor_time(id));
    }
    for (const Firing& firing : firings) {
        note(Moment::of_triggered(firing.timepoint), firing.triggered);
        note(Moment::of_fired(firing.timepoint), firing.fired);
    }
    if (const auto waiting = timeline.waiting()) note(Moment::of_triggered(timeline.current()), waiting->triggered);
}

void ConstraintMonitor::note(const Moment& moment, MaybeTime time) {
    MaybeTime& known = time_of(moment);
    if (known.get() == time.get()) return;
    known = time;
    if (!time.defined()) return;
    for (std::size_t i = 0; i < rows_.size(); ++i)
        if (rows_[i].to == moment || (rows_[i].from == moment && !judged_[i])) judge(i);
}

void ConstraintMonitor::judge(std::size_t row) {
    const ConstraintSpec& spec = rows_[row];
    const auto& from = time_of(spec.from).get();
    const auto& to = time_of(spec.to).get();
    if (!from || !to) return;
    judged_[row] = true;
    const double elapsed_s = *to - *from;
    const auto bounds = timeline::bounds_of(spec);
    if (!bounds.too_soon(elapsed_s) && !bounds.too_late(elapsed_s)) return;
    ++violations_;
    (void)waiting_.try_push({static_cast<std::uint16_t>(row), elapsed_s});
}

void ConstraintMonitor::report(Outbox& out) {
    for (std::size_t sent = 0; sent < reports_per_cycle_max && !waiting_.empty(); ++sent) {
        const auto [number, elapsed_s] = waiting_.front();
        waiting_.pop();
        const ConstraintSpec& row = rows_[number];
        const bool too_soon = timeline::bounds_of(row).too_soon(elapsed_s);
        out.event(evr::SUB_CONSTRAINT_VIOLATED{.constraint = number,
                                               .elapsed_s = elapsed_s,
                                               .bound_s = too_soon ? *row.minimum_s : *row.maximum_s,
                                               .violations = violations_});
        out.record(explanation(number, row, elapsed_s));
        out.send(ModuleId::mfsk, ToneRequest{tone::constraint_violated, out.now()});
    }
}

void ConstraintMonitor::summarise(Outbox& out) const {
    out.event(
        evr::SUB_CONSTRAINTS_JUDGED{.judged = static_cast<std::uint16_t>(judged_.count()), .violations = violations_});
}

MaybeTime& ConstraintMonitor::time_of(const Moment& moment) {
    switch (moment.kind) {
    case Moment::Kind::anchor: AEOLIS_CHECK(moment.index < anchors_.size()); return anchors_[moment.index];
    case Moment::Kind::triggered: AEOLIS_CHECK(moment.index < triggered_.size()); return triggered_[moment.index];
    case Moment::Kind::fired: AEOLIS_CHECK(moment.index < fired_.size()); return fired_[moment.index];
    case Moment::Kind::do_edl: break;
    }
    return do_edl_;
}

}  // namespace aeolis::flight
