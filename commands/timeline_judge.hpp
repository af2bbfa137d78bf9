// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "dictionaries/decoded.hpp"
#include "dictionaries/dictionary.hpp"
#include "dictionaries/timeline_change_rule.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace aeolis::commands {

/// Judges a change of the timeline on ground, on the timeline as it will stand when the change arrives. R19, R51
///
/// In      live packets; changes made or under way; a requested change
/// Out     why the change is unsafe; nothing where it is safe, or where ground does not know
/// Rule    dictionaries/timeline_change_rule.hpp, applied to what was heard and, until the arrival, to what fires by
///         the plan. Flight judges again by its own state
/// Memory  the times of all timepoints, and the offsets. A value
class TimelineJudge {
  public:
    /// The dictionary must outlive this and its copies.
    explicit TimelineJudge(const dictionary::Dictionary& dictionary);

    /// Reads the vehicle's two packets about its timeline; ignores all others.
    void hear(const dictionary::Decoded& packet);

    /// Applies a change that flight has made, or is about to make.
    void make(const timeline::Change& change);

    /// The reason why the change is unsafe; none: it is safe, or ground does not know.
    ///
    /// @param navigated_entry  by ground's own navigation solution, if there is one
    /// @param arrives  at the vehicle; none: its clock is not known, and only what holds at any time is judged
    std::optional<timeline::Unsafe> judge(const timeline::Change& change, std::optional<Sclk> navigated_entry,
                                          std::optional<Sclk> arrives) const;
    /// Seconds by which "do edl" would arrive too late for its first timepoint on the clock. None: in time, or unknown.
    /// R23
    std::optional<double> begins_late_s(std::optional<Sclk> navigated_entry, std::optional<Sclk> arrives) const;
    /// The reason as text for controllers.
    std::string text(const timeline::Unsafe& unsafe) const;

  private:
    class Plan;
    /// Indices of packets and fields; none where the dictionary lacks them.
    struct StatusFields {
        std::optional<std::size_t> packet, current, state, next_minimum;
        std::vector<std::pair<AnchorId, std::size_t>> anchors;  ///< under the root: time equals offset
    };
    struct FiringFields {
        std::optional<std::size_t> packet, timepoint, triggered, fired;
    };
    StatusFields status_fields() const;
    FiringFields firing_fields() const;
    void hear_status(const dictionary::Decoded& packet);
    void hear_firing(const dictionary::Decoded& packet);
    bool is_decided_in_flight(std::size_t anchor) const;
    std::optional<double> parameter(std::string_view name) const;
    /// Sets entry by ground's navigation, unless the vehicle has reported it.
    void assume_entry(std::optional<Sclk> navigated);
    /// Advances to `to`, firing timepoints by the plan up to the first that waits for a decision of GNC.
    void advance(Sclk to);

    const dictionary::Dictionary* dictionary_;  ///< never null; a pointer, so that a judge can be assigned
    StatusFields status_;
    FiringFields firing_;
    std::optional<AnchorId> entry_;
    std::vector<timeline::Offsets> offsets_;   ///< by timepoint
    std::vector<MaybeOffset> anchor_offsets_;  ///< by anchor
    timeline::Standing standing_;              ///< as last heard
    timeline::Times known_;
};

}  // namespace aeolis::commands
