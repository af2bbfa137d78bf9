// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/timeline_rule.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <variant>

// The rule of a safe change of the timeline, applied when the change arrives. R19, R51
// Ground applies it to what it has heard, flight to what it holds: one rule, two judges, no shared state.
//
// Plan         The rows and anchors as they stand: any type with
//                rows()  offsets(row)  reply_timeout_s(row)  is_essential(row)
//                anchors()  parent(anchor)  anchor_offset_s(anchor)  is_decided_in_flight(anchor)
//                constraints()  the rows of constraints.csv
// Projection   The firings from now on, each as early as the timeline's rule allows. An anchor that GNC has yet to
//              decide comes at the earliest time that constraints.csv gives. A change does not move it.
// Comparison   The projection with the change against the projection without it. A fault that both have does not count.
// Not judged   Dispatch: after a restart or a hand-over, overdue timepoints must fire together.
// Memory       Two `Times`, owned by the caller
namespace aeolis::timeline {

inline constexpr std::size_t rows_max = 160;    ///< chosen: twice the shipped timeline
inline constexpr std::size_t anchors_max = 32;  ///< chosen: over twice the shipped anchors

inline constexpr std::size_t burst_rows_max = 5;  ///< most triggerings within `burst_s`; the shipped plan has four. R51
inline constexpr double burst_s = 1.0;            ///< R51
inline constexpr double exact_s = seconds_per_tick / 2.0;  ///< times that differ by less are equal

/// A change of a timepoint's offsets, as a command makes it.
struct TimepointChange {
    TimepointId id;
    MaybeOffset desired_s, minimum_s;
};
/// A change of an anchor's offset.
struct AnchorChange {
    AnchorId id;
    MaybeOffset offset_s;  ///< from its parent
};
using Change = std::variant<TimepointChange, AnchorChange>;

/// The time of each moment of a timeline, past or projected; undefined where unknown.
struct Times {
    MaybeTime do_edl;
    std::array<MaybeTime, anchors_max> anchors{};
    std::array<MaybeTime, rows_max> triggered{}, fired{};

    constexpr MaybeTime of(const Moment& moment) const {
        switch (moment.kind) {
        case Moment::Kind::do_edl: break;
        case Moment::Kind::anchor: return anchors[moment.index];
        case Moment::Kind::triggered: return triggered[moment.index];
        case Moment::Kind::fired: return fired[moment.index];
        }
        return do_edl;
    }
};

/// The progress of a timeline at one instant.
struct Standing {
    Sclk now;
    std::size_t current = 0;     ///< the first timepoint that has not fired
    bool waiting = false;        ///< `current` was triggered and its reply is due
    MaybeTime previous_fired{};  ///< undefined: "do edl" is outstanding, and assumed to come now

    /// The first timepoint that has not been triggered.
    constexpr std::size_t next() const { return waiting ? current + 1 : current; }
};

/// The reason why a change is unsafe.
struct Unsafe {
    enum class Why : std::uint8_t {
        decided_in_flight,  ///< the anchor is GNC's
        not_navigated,      ///< the judge's own navigation gives another time of entry
        triggered_already,  ///< the timepoint's action has begun
        overdue,            ///< the timepoint's time would have passed: it would fire at once
        burst,              ///< the timepoint would be the sixth within a second, which the plan avoids
        too_soon,           ///< a constraint's minimum would be missed
        too_late,           ///< a constraint's maximum would be exceeded
    };
    Why why{};
    Moment what;                              ///< the anchor, or the triggering of the timepoint
    double by_s = 0.0;                        ///< amount by which the bound is missed
    std::optional<std::size_t> constraint{};  ///< index of the broken row
};

/// A plan with one change applied.
template <typename Plan>
class ChangedPlan {
  public:
    constexpr ChangedPlan(const Plan& plan, const Change& change) : plan_(plan), change_(change) {}

    constexpr std::size_t rows() const { return plan_.rows(); }
    constexpr Offsets offsets(std::size_t row) const {
        Offsets offsets = plan_.offsets(row);
        if (const auto* change = std::get_if<TimepointChange>(&change_); change && change->id.value == row) {
            offsets.desired_s = change->desired_s;
            offsets.minimum_s = change->minimum_s;
        }
        return offsets;
    }
    constexpr std::optional<double> reply_timeout_s(std::size_t row) const { return plan_.reply_timeout_s(row); }
    constexpr std::size_t anchors() const { return plan_.anchors(); }
    constexpr std::optional<AnchorId> parent(std::size_t anchor) const { return plan_.parent(anchor); }
    constexpr MaybeOffset anchor_offset_s(std::size_t anchor) const {
        const auto* change = std::get_if<AnchorChange>(&change_);
        return change && change->id.value == anchor ? change->offset_s : plan_.anchor_offset_s(anchor);
    }
    constexpr decltype(auto) constraints() const { return plan_.constraints(); }

  private:
    const Plan& plan_;
    const Change& change_;
};

/// Assumption about replies: the earliest and the latest.
enum class Replies : std::uint8_t { at_once, at_timeout };

/// The earliest time at which GNC can decide the anchor: by constraints.csv, and not before now.
template <typename Plan>
constexpr Sclk earliest_decision(const Plan& plan, AnchorId anchor, Sclk now, const Times& times) {
    Sclk earliest = now;
    for (const auto& row : plan.constraints())
        if (row.to == Moment::of_anchor(anchor))
            if (const auto least = (times.of(row.from) + row.minimum_s).get()) earliest = std::max(earliest, *least);
    return earliest;
}

/// Projects the anchors and all firings from now on into `times`, which already holds the past firings.
///
/// @param decided_as  a projection that has the times of undecided anchors; null: the earliest
template <typename Plan>
constexpr void project(const Plan& plan, const Standing& at, Replies replies, const Times* decided_as, Times& times) {
    for (std::size_t i = 0; i < plan.anchors(); ++i) {
        const auto parent = plan.parent(i);
        times.anchors[i] =
            parent ? anchor_time(times.anchors[parent->value], plan.anchor_offset_s(i)) : MaybeTime{Sclk{}};
    }
    if (!at.previous_fired.defined()) times.do_edl = at.now;
    MaybeTime previous = at.previous_fired.defined() ? at.previous_fired : times.do_edl;
    for (std::size_t i = at.current; i < plan.rows(); ++i) {
        if (i >= at.next()) {
            const Offsets offsets = plan.offsets(i);
            MaybeTime anchor;
            if (offsets.anchor) {
                MaybeTime& time = times.anchors[offsets.anchor->value];
                if (!time.defined() && decided_as != nullptr) time = decided_as->anchors[offsets.anchor->value];
                if (!time.defined()) time = earliest_decision(plan, *offsets.anchor, at.now, times);
                anchor = time;
            }
            const auto due = due_times(offsets, previous, anchor);
            times.triggered[i] = {};
            if (due.desired.defined() && due.minimum.defined() && previous.defined()) {
                Sclk when = std::max({at.now, *previous.get(), *due.desired.get(), *due.minimum.get()});
                if (i >= triggered_per_cycle_max)
                    if (const auto& fifth_before = times.triggered[i - triggered_per_cycle_max].get())
                        when = std::max(when, *fifth_before + seconds_per_tick);
                times.triggered[i] = when;
            }
        }
        times.fired[i] = {};
        if (const auto& triggered = times.triggered[i].get()) {
            const auto timeout_s = replies == Replies::at_timeout ? plan.reply_timeout_s(i) : std::nullopt;
            times.fired[i] = std::max(at.now, latest_firing(*triggered, timeout_s));
        }
        previous = times.fired[i];
    }
}

/// The amounts by which a row of constraints.csv is missed; not positive: it holds, or is not known.
struct Missed {
    double too_soon_s = 0.0, too_late_s = 0.0;
};
template <typename Row>
constexpr Missed missed(const Row& row, const Times& times) {
    const auto from = times.of(row.from).get(), to = times.of(row.to).get();
    if (!from || !to) return {};
    const double elapsed_s = *to - *from;
    return {row.minimum_s ? *row.minimum_s - elapsed_s : 0.0, row.maximum_s ? elapsed_s - *row.maximum_s : 0.0};
}

/// The time at which its anchor makes the timepoint due. Undefined without an anchor.
template <typename Plan>
constexpr MaybeTime hour(const Plan& plan, std::size_t row, const Times& times) {
    const Offsets offsets = plan.offsets(row);
    return offsets.anchor ? times.anchors[offsets.anchor->value] + offsets.desired_s : MaybeTime{};
}

/// The time between the triggering of `row` and that of the fifth row before it; none where one is unknown.
constexpr std::optional<double> span_of_six_s(std::size_t row, const Times& times) {
    if (row < burst_rows_max) return std::nullopt;
    const auto &last = times.triggered[row].get(), &first = times.triggered[row - burst_rows_max].get();
    return last && first ? std::optional{*last - *first} : std::nullopt;
}

/// The first fault of the projection `after` the change that the projection `before` it does not have.
template <typename Plan>
constexpr std::optional<Unsafe> compare(const Plan& plan, const Change& change, const Standing& at, const Times& before,
                                        const Times& after) {
    using Why = Unsafe::Why;
    const ChangedPlan changed{plan, change};
    const auto triggering = [](std::size_t row) {
        return Moment{Moment::Kind::triggered, static_cast<std::uint16_t>(row)};
    };
    const auto has_passed = [&](MaybeTime time) { return time.defined() && *time.get() < at.now; };
    for (std::size_t i = at.next(); i < plan.rows(); ++i)
        if (const auto is = hour(changed, i, after); has_passed(is) && !has_passed(hour(plan, i, before)))
            return Unsafe{Why::overdue, triggering(i), at.now - *is.get()};
    for (std::size_t i = at.next(); i < plan.rows(); ++i) {
        const auto was_s = span_of_six_s(i, before), is_s = span_of_six_s(i, after);
        if (is_s && *is_s < burst_s && !(was_s && *was_s < burst_s))
            return Unsafe{Why::burst, triggering(i), burst_s - *is_s};
    }
    std::size_t number = 0;
    for (const auto& row : plan.constraints()) {
        const std::size_t constraint = number++;
        const bool to_anchor = row.to.kind == Moment::Kind::anchor;
        // GNC's decisions are given. Rows that Second Chance omits are monitored in flight, not enforced.
        if (to_anchor ? plan.is_decided_in_flight(row.to.index) : !plan.is_essential(row.to.index)) continue;
        const Missed was = missed(row, before), is = missed(row, after);
        const Moment what = to_anchor ? row.to : triggering(row.to.index);
        if (is.too_soon_s > std::max(0.0, was.too_soon_s) + exact_s)
            return Unsafe{Why::too_soon, what, is.too_soon_s, constraint};
        if (is.too_late_s > std::max(0.0, was.too_late_s) + exact_s)
            return Unsafe{Why::too_late, what, is.too_late_s, constraint};
    }
    return std::nullopt;
}

/// The reason why the change is unsafe now; none: it is safe.
///
/// @param before, after  in: the past firings; out: the projections without and with the change
template <typename Plan>
constexpr std::optional<Unsafe> unsafe_change(const Plan& plan, const Change& change, const Standing& at, Times& before,
                                              Times& after) {
    using Why = Unsafe::Why;
    if (const auto* anchor = std::get_if<AnchorChange>(&change); anchor && plan.is_decided_in_flight(anchor->id.value))
        return Unsafe{Why::decided_in_flight, Moment::of_anchor(anchor->id)};
    if (const auto* timepoint = std::get_if<TimepointChange>(&change); timepoint && timepoint->id.value < at.next())
        return Unsafe{Why::triggered_already, Moment::of_triggered(timepoint->id)};
    for (const Replies replies : {Replies::at_once, Replies::at_timeout}) {
        project(plan, at, replies, nullptr, before);
        project(ChangedPlan{plan, change}, at, replies, &before, after);
        if (const auto unsafe = compare(plan, change, at, before, after)) return unsafe;
    }
    return std::nullopt;
}

/// The reason why entry cannot be at `said`: the judge's own navigation gives a time more than `most_s` away, or none.
constexpr std::optional<Unsafe> unsafe_entry(AnchorId entry, Sclk said, MaybeTime navigated, double most_s) {
    const double late_s = navigated.defined() ? said - *navigated.get() : 0.0;
    if (navigated.defined() && late_s <= most_s && late_s >= -most_s) return std::nullopt;
    return Unsafe{Unsafe::Why::not_navigated, Moment::of_anchor(entry), late_s};
}

}  // namespace aeolis::timeline
