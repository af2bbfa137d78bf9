// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <functional>
#include <string>
#include <vector>

// Proof that the timeline's explicit constraints imply the required rows of constraints.csv. R19
//
// Explicit    By dictionaries/timeline_rule.hpp, as the engine on board applies it: a timepoint is triggered as soon as
//             it may be. It fires when its reply arrives, at any time up to the time-out.
// Free        The acceptance of "do edl", and every anchor whose offset is undefined (ground's entry time, GNC's
//             triggers), within the given and ensured rows of constraints.csv.
// Held        No row that is not essential may hold one that GNC triggers, however early GNC does. Proven with the
//             ensured rows alone: a given row is an expectation, which a flight may break.
// Left out    Offsets changed by command. Exception: a timepoint with an undefined offset is free, at any time after
//             its predecessor. An anchor is assumed to be known early enough for a negative offset from it.
// Method      Difference constraints over ticks of 1/64 s. "As soon as" is a disjunction: one of the causes came last.
//             The search first solves without it, and branches only where the solution is late without a cause.
namespace aeolis::dictionary {

/// One constraint in a chain: to - from >= at_least_s.
struct ChainStep {
    enum class Reason {
        order,          ///< in the order of the timeline
        minimum,        ///< the minimum offset from the previous timepoint
        desired,        ///< the desired offset
        cycle_limit,    ///< at most five are triggered in one cycle
        reply,          ///< fires not before it is triggered
        reply_timeout,  ///< fires at its time-out at the latest
        anchor_offset,  ///< the anchor's offset from its parent
        given,          ///< a given row of constraints.csv
        as_soon_as,     ///< triggered without delay when its last cause comes
    };
    Moment from, to;
    double at_least_s = 0.0;
    Reason reason = Reason::order;
    unsigned line = 0;  ///< in constraints.csv when given, in timeline.csv for timepoints, 0 for anchors
};

struct Instant {
    Moment moment;
    double time_s = 0.0;  ///< from the acceptance of "do edl"
};

enum class Proof { proven, refuted, undecided };

/// Result for one bound of one required row.
struct BoundProof {
    std::size_t constraint = 0;  ///< index in Dictionary::constraints
    bool is_minimum = true;      ///< of minimum_s; else of maximum_s
    Proof proof = Proof::undecided;
    /// Margin between the bound and the worst schedule; undefined: the worst case is unbounded.
    /// Proven: not negative.
    MaybeOffset slack_s;
    std::vector<ChainStep> chain;  ///< critical chain: the constraints that limit the worst case; empty when nothing
                                   ///< limits it
    /// A schedule of all moments that reaches the worst case, or, if unbounded, one that breaks the row by 1/64 s.
    std::vector<Instant> schedule;
};

/// Worst case of the margin by which a timepoint is free to fire before its anchor makes it due.
struct DueMargin {
    TimepointId timepoint;
    MaybeOffset slack_s;  ///< negative: it may fire that late; undefined: unbounded, the anchor may be set at any time
};

/// Whether a timepoint that GNC triggers can wait for an earlier one that GNC does not need.
struct HoldProof {
    TimepointId triggered;  ///< due when GNC says "now"
    TimepointId before;     ///< not essential
    Proof proof = Proof::undecided;
    std::vector<Instant> schedule;  ///< refuted: one in which it waits
};

struct TimelineAnalysis {
    /// The cycle of constraints by which the timeline and the given rows admit no schedule.
    /// If set, the rest is empty.
    std::vector<ChainStep> contradiction;
    bool stopped = false;  ///< stopped on request before it was done: the results are incomplete
    /// False, with no contradiction: no schedule has a cause for every firing.
    bool admits_schedule = true;
    std::vector<BoundProof> bounds;
    std::vector<DueMargin> margins;  ///< of the timepoints with an anchor
    std::vector<HoldProof> holds;    ///< each timepoint that GNC triggers with each before it that is not essential

    /// Whether every bound and every hold is proven.
    bool all_proven() const;
};

/// Analyses the timeline.
/// `stop` is called at each step, some thousand times a second; null: runs to the end.
TimelineAnalysis analyse_timeline(const Dictionary& dictionary, const std::function<bool()>& stop = {});
/// Analyses the bounds alone.
TimelineAnalysis analyse_bounds(const Dictionary& dictionary, const std::function<bool()>& stop = {});

/// Text of a moment as in constraints.csv: "do_edl", "parachute:anchor", "radar_power:fired".
std::string moment_text(const Dictionary& dictionary, const Moment& moment);

}  // namespace aeolis::dictionary
