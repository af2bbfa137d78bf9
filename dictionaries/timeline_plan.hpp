// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <limits>
#include <optional>
#include <variant>
#include <vector>

// Ground's plan and prediction of a timeline, by timeline_rule.hpp. All times are seconds from the entry that was
// predicted when the run began. Replies are taken to come at once.
namespace aeolis::dictionary {

/// A change of offsets, as a command makes it on board.
struct OffsetChange {
    struct OfTimepoint {
        TimepointId id;
        MaybeOffset desired_s, minimum_s;
    };
    struct OfAnchor {
        AnchorId id;
        MaybeOffset offset_s;  ///< from its parent
    };
    std::variant<OfTimepoint, OfAnchor> what;
    double since_e_s = std::numeric_limits<double>::infinity();  ///< when flight made it; infinite: it is yet to do so
};

/// What ground knows of a timeline at one instant.
struct TimelineKnowledge {
    struct Heard {
        double triggered_e_s = 0.0, fired_e_s = 0.0;
    };
    struct Report {
        double anchor_e_s = 0.0;
        double at_e_s = 0.0;  ///< when flight wrote it
    };
    std::vector<MaybeOffset> design_e_s;         ///< by anchor: when the design has it (predicted_anchors.csv)
    std::vector<std::optional<Heard>> heard;     ///< by timepoint; may be shorter than the timeline
    std::vector<std::optional<Report>> reports;  ///< by anchor: the time that flight says it holds; may be shorter
    std::vector<OffsetChange> changes;           ///< oldest first
    MaybeOffset clock_zero_e_s;                  ///< the zero of the spacecraft clock, where the root anchor stands
    MaybeOffset now_e_s;                         ///< how far the vehicle has been heard; none: nothing is overdue
};

struct TimelinePrediction {
    struct Anchor {
        enum class Basis : std::uint8_t {
            nothing,  ///< nobody knows it, nor predicts it
            clock,    ///< the root
            report,   ///< flight's own word
            firing,   ///< a timepoint of it has fired
            command,  ///< flight has made a change of it
            parent,   ///< its offset from its parent
            plan,     ///< entry, as it was predicted when the run began
            design,   ///< its distance in the design from the anchor before it
            overdue,  ///< the design had it before now
        };
        MaybeOffset e_s;
        Basis basis = Basis::nothing;
        MaybeOffset offset_s;               ///< from its parent, as the last change has it
        std::optional<TimepointId> firing;  ///< the one that tells it
        /// Decided on board, or following from what is. What else has a time is predicted.
        bool defined = false;
    };
    struct Timepoint {
        enum class Unknown : std::uint8_t {
            nothing,   ///< it is predicted
            offset,    ///< its desired or minimum offset is undefined
            anchor,    ///< its anchor has no time
            previous,  ///< the one before it is not predicted; before the first: "do edl"
        };
        MaybeOffset e_s;  ///< of one that has fired: as predicted before its anchor was heard of
        Unknown unknown = Unknown::nothing;
    };
    std::vector<Anchor> anchors;
    std::vector<Timepoint> timepoints;
    MaybeOffset latest_begin_e_s;  ///< of an acceptance of "do edl" with which nothing is overdue
};

/// When each anchor and each timepoint comes, as far as anyone can say.
///
/// Anchors     By the vehicle's report or an executed change, whichever is newer; else by what has fired of it, which
///             overtakes a change made before. Else by the offset from its parent, the plan, or its distance in the
///             design from the anchor before it; one of the design that is overdue comes now at the earliest
/// Timepoints  By the rule. A previous firing whose time nobody knows holds nothing up
TimelinePrediction predict(const Dictionary& dictionary, const TimelineKnowledge& known);

/// When each timepoint would fire if nothing but the plan decided; none where that depends on what happens in flight.
std::vector<MaybeOffset> planned_from_entry_s(const Dictionary& dictionary);

/// When each timepoint is predicted, with what was heard until then.
///
/// @param design_e_s  by anchor
/// @param heard_e_s  by timepoint: when it fired, as far as ground had heard of it
std::vector<MaybeOffset> predicted_from_entry_s(const Dictionary& dictionary,
                                                const std::vector<MaybeOffset>& design_e_s,
                                                const std::vector<MaybeOffset>& heard_e_s);

}  // namespace aeolis::dictionary
