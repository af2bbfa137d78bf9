// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ids.hpp"
#include "common/time.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>

// The timeline's rule: when a timepoint is triggered, when it fires, and whether a constraint holds.
// Shared by the engine on board and its monitor, the analysis, ground's plan and prediction, and the venues without a
// timeline.
//
// Sequence     A timepoint is triggered once the previous one has fired, and its desired offset and its minimum offset
//              have elapsed. For the first, the acceptance of "do edl" stands for the previous firing. R11, R16
// Undefined    A time that is undefined, or depends on an undefined offset, is never reached. R13
// Reply        A timepoint fires when it is triggered. One that waits for a reply fires when the reply arrives, or at
//              its time-out. R14
// Cycle        At most five timepoints are triggered in one cycle. R15
// Anchors      The time of an anchor is its parent's time plus its offset. The root is the zero of the clock. R17
// Constraints  minimum <= to - from <= maximum. R19
// Memory       None: every function is pure, and fit for flight
// Clock        Any whose zero all times share: SCLK on board, seconds from entry in a plan
namespace aeolis::timeline {

inline constexpr std::size_t triggered_per_cycle_max = 5;  ///< so as not to overload the processor. R15

/// An instant that a constraint refers to.
struct Moment {
    enum class Kind : std::uint8_t {
        do_edl,     ///< "do edl" is accepted
        anchor,     ///< the time of the anchor; it may be in the future
        triggered,  ///< the timepoint's action begins
        fired,      ///< its reply arrived, or its time-out; without a reply, the instant of triggering
    };
    Kind kind = Kind::do_edl;
    std::uint16_t index = 0;  ///< of the anchor or timepoint
    constexpr bool operator==(const Moment&) const = default;

    static constexpr Moment of_do_edl() { return {}; }
    static constexpr Moment of_anchor(AnchorId id) { return {Kind::anchor, id.value}; }
    static constexpr Moment of_triggered(TimepointId id) { return {Kind::triggered, id.value}; }
    static constexpr Moment of_fired(TimepointId id) { return {Kind::fired, id.value}; }
};

/// The offsets of a timepoint.
struct Offsets {
    std::optional<AnchorId> anchor;  ///< none: the desired offset, too, counts from the previous firing
    MaybeOffset desired_s;
    MaybeOffset minimum_s;     ///< from the previous firing
    bool may_be_late = false;  ///< fires at once, without harm, when "do edl" comes after its time
};
/// Offsets of a row of timeline.csv, as the dictionary or flight holds it.
template <typename Row>
constexpr Offsets offsets_of(const Row& row) {
    return {row.anchor, row.desired_offset_s, row.minimum_offset_s, row.may_be_late};
}

/// One of the two conditions for triggering: `offset_s` after `from`.
struct Condition {
    enum class From : std::uint8_t { previous_firing, anchor };
    From from = From::previous_firing;
    MaybeOffset offset_s;
};
struct Conditions {
    Condition desired, minimum;
};
constexpr Conditions conditions_of(const Offsets& offsets) {
    using From = Condition::From;
    return {{offsets.anchor ? From::anchor : From::previous_firing, offsets.desired_s},
            {From::previous_firing, offsets.minimum_s}};
}

/// The times of both conditions for triggering.
struct DueTimes {
    MaybeTime desired, minimum;

    constexpr bool have_come(Sclk now) const { return now >= desired && now >= minimum; }
};
/// @param anchor  the time of the timepoint's anchor, if it has one
constexpr DueTimes due_times(const Offsets& offsets, MaybeTime previous_fired, MaybeTime anchor) {
    const auto time_of = [&](const Condition& condition) {
        return (condition.from == Condition::From::anchor ? anchor : previous_fired) + condition.offset_s;
    };
    const auto conditions = conditions_of(offsets);
    return {time_of(conditions.desired), time_of(conditions.minimum)};
}

/// The latest time at which a timepoint fires: its time-out, or without a reply its triggering.
constexpr Sclk latest_firing(Sclk triggered, const std::optional<double>& reply_timeout_s) {
    return reply_timeout_s ? triggered + *reply_timeout_s : triggered;
}

/// Time of any anchor except the root.
constexpr MaybeTime anchor_time(MaybeTime parent, MaybeOffset offset_s) {
    return parent + offset_s;
}

/// Latest time at which "do edl" can be accepted so that no timepoint is overdue except those that may be late. R23
/// It is the desired time of the first timepoint that has an anchor and may not be late, less the durations of those
/// before it. Undefined while that anchor is undefined, or when there is no such timepoint.
/// @param offsets_of  Offsets of a row         @param reply_timeout_of  of a row, if any
/// @param anchor_time_of  MaybeTime of an AnchorId
constexpr MaybeTime latest_begin(std::size_t rows, const auto& offsets_of, const auto& reply_timeout_of,
                                 const auto& anchor_time_of) {
    double before_s = 0.0;
    for (std::size_t i = 0; i < rows; ++i) {
        const Offsets offsets = offsets_of(i);
        if (offsets.anchor && !offsets.may_be_late)
            return anchor_time_of(*offsets.anchor) + offsets.desired_s + MaybeOffset{-before_s};
        const MaybeOffset waits_s = offsets.anchor ? offsets.minimum_s : offsets.desired_s;
        before_s += waits_s.value_or(0.0) + reply_timeout_of(i).value_or(0.0);
    }
    return {};
}

/// Bounds on the time from one moment to another; undefined: no bound.
struct Bounds {
    MaybeOffset minimum_s, maximum_s;

    constexpr bool too_soon(double elapsed_s) const { return minimum_s && elapsed_s < *minimum_s; }
    constexpr bool too_late(double elapsed_s) const { return maximum_s && elapsed_s > *maximum_s; }
};
/// Bounds of a row of constraints.csv, as the dictionary or flight holds it.
template <typename Row>
constexpr Bounds bounds_of(const Row& row) {
    return {row.minimum_s, row.maximum_s};
}

}  // namespace aeolis::timeline
