// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "dictionaries/timeline_change_rule.hpp"

#include <limits>
#include <optional>
#include <vector>

// Ground's plan and prediction of a timeline, by timeline_rule.hpp.
// All times are seconds from the entry time predicted when the run began. Replies are assumed to be immediate.
namespace aeolis::dictionary {

/// A change of offsets that a command makes on board.
struct OffsetChange {
    using OfTimepoint = timeline::TimepointChange;
    using OfAnchor = timeline::AnchorChange;
    timeline::Change what;
    double since_e_s = std::numeric_limits<double>::infinity();  ///< when flight made it; infinite: not yet
};

/// Ground's knowledge of a timeline at one instant.
struct TimelineKnowledge {
    struct Firing {
        double triggered_e_s = 0.0, fired_e_s = 0.0;
    };
    struct Report {
        double anchor_e_s = 0.0;
        double at_e_s = 0.0;  ///< when flight wrote the report
    };
    std::vector<MaybeOffset> design_e_s;         ///< by anchor: its time in the design (predicted_anchors.csv)
    std::vector<std::optional<Firing>> heard;    ///< by timepoint; may be shorter than the timeline
    std::vector<std::optional<Report>> reports;  ///< by anchor: the time that flight reports for it; may be shorter
    std::vector<OffsetChange> changes;           ///< oldest first
    MaybeOffset clock_zero_e_s;                  ///< zero of the spacecraft clock, which is the time of the root anchor
    MaybeOffset now_e_s;                         ///< the latest time heard from the vehicle; none: nothing is overdue
};

struct TimelinePrediction {
    struct Anchor {
        enum class Basis : std::uint8_t {
            nothing,  ///< neither known nor predicted
            clock,    ///< the root
            report,   ///< reported by flight
            firing,   ///< a timepoint anchored to it has fired
            command,  ///< flight has executed a change of it
            parent,   ///< its offset from its parent
            plan,     ///< entry, as predicted when the run began
            design,   ///< its distance in the design from the previous anchor
            overdue,  ///< its time in the design has passed
        };
        MaybeOffset e_s;
        Basis basis = Basis::nothing;
        MaybeOffset offset_s;               ///< from its parent, after the last change
        std::optional<TimepointId> firing;  ///< the timepoint whose firing gives its time
        /// Decided on board, or derived from such a time. Every other time is a prediction.
        bool defined = false;
    };
    struct Timepoint {
        enum class Unknown : std::uint8_t {
            nothing,   ///< it is predicted
            offset,    ///< its desired or minimum offset is undefined
            anchor,    ///< its anchor has no time
            previous,  ///< the previous timepoint is not predicted; for the first: "do edl" is not
        };
        MaybeOffset e_s;  ///< if it has fired: as predicted before its anchor was reported
        Unknown unknown = Unknown::nothing;
    };
    std::vector<Anchor> anchors;
    std::vector<Timepoint> timepoints;
    MaybeOffset latest_begin_e_s;  ///< the latest acceptance of "do edl" with which nothing is overdue
};

/// Predicts the time of each anchor and each timepoint, from everything known.
///
/// Anchors     By the vehicle's report or an executed change, whichever is newer; otherwise by a firing relative to it,
///             which overrides an earlier change. Otherwise by the offset from its parent, the plan, or its distance in
///             the design from the previous anchor. An overdue time of the design is moved to now
/// Timepoints  By the rule. A previous firing at an unknown time delays nothing
TimelinePrediction predict(const Dictionary& dictionary, const TimelineKnowledge& known);

/// Times at which timepoints fire by the plan alone; none where that depends on events in flight.
std::vector<MaybeOffset> planned_from_entry_s(const Dictionary& dictionary);

/// Predicted time of each timepoint, from what had been heard until then.
///
/// @param design_e_s  by anchor
/// @param heard_e_s  by timepoint: when it fired, as far as ground had heard
std::vector<MaybeOffset> predicted_from_entry_s(const Dictionary& dictionary,
                                                const std::vector<MaybeOffset>& design_e_s,
                                                const std::vector<MaybeOffset>& heard_e_s);

}  // namespace aeolis::dictionary
