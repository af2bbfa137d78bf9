// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <functional>
#include <string>
#include <vector>

// Whether the timeline's explicit constraints imply those of constraints.csv. R19
//
// Explicit    By dictionaries/timeline_rule.hpp, as the engine on board decides: a timepoint is triggered as soon as it
//             may be, and fires when its reply comes, at any time until the time-out.
// Free        When "do edl" is accepted, and every anchor whose offset is undefined (ground's entry time, GNC's
//             triggers), within the given rows of constraints.csv.
// Left out    Offsets changed by command, but for an undefined offset, which leaves its timepoint free: after its
//             predecessor, at any time. An anchor is taken as known in time for what has a negative offset from it.
// Method      Difference constraints over ticks of 1/64 s. "As soon as" is a choice: one of the causes was the last to
//             come. The search solves without it, and chooses only where the solution is late without a cause.
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

/// What became of one bound of one required row.
struct BoundProof {
    std::size_t constraint = 0;  ///< index in Dictionary::constraints
    bool is_minimum = true;      ///< of minimum_s; else of maximum_s
    Proof proof = Proof::undecided;
    /// What is left between the bound and the worst schedule; undefined: that has no bound. Proven: not negative.
    MaybeOffset slack_s;
    std::vector<ChainStep> chain;  ///< critical: what forces the worst case to be no worse; empty when nothing does
    /// A schedule of every moment that reaches the worst case, or, where that has no bound, breaks the row by 1/64 s.
    std::vector<Instant> schedule;
};

/// How long before its anchor makes it due a timepoint is free to fire, in the worst case.
struct DueMargin {
    TimepointId timepoint;
    MaybeOffset
        slack_s;  ///< negative: it may fire so much late; undefined: no bound, the anchor may be set at any time
};

struct TimelineAnalysis {
    /// Not empty: the timeline and the given rows admit no schedule, by this ring; then nothing else is there.
    std::vector<ChainStep> contradiction;
    bool stopped = false;  ///< it was asked to end before it was done: what is there is not all
    /// Without a ring of its own: no schedule has a cause for every firing.
    bool admits_schedule = true;
    std::vector<BoundProof> bounds;
    std::vector<DueMargin> margins;  ///< of the timepoints with an anchor

    bool all_proven() const;
};

/// `stop` is asked at each step of the search, some thousand times a second; null: the analysis goes on to its end.
TimelineAnalysis analyse_timeline(const Dictionary& dictionary, const std::function<bool()>& stop = {});
/// The same without the margins, which decide nothing.
TimelineAnalysis analyse_bounds(const Dictionary& dictionary, const std::function<bool()>& stop = {});

/// As in constraints.csv: "do_edl", "parachute:anchor", "radar_power:fired".
std::string moment_text(const Dictionary& dictionary, const Moment& moment);

}  // namespace aeolis::dictionary
