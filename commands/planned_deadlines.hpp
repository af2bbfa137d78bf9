// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands/encoder.hpp"
#include "common/time.hpp"
#include "dictionaries/dictionary.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace aeolis::commands {

/// Until when a command is of use: what is planned by the clock, and the light time before it.
///
/// In       the dictionary's timeline; the entry that was predicted when the run began      Out   Earth's clock, names
///          of timepoints
/// Rule     a command that changes an offset must be there before what it moves, which where its time is decided in
///          flight is as predicted (predicted_anchors.csv); any other before the next that is planned. An offset that
///          flight has changed counts as it is then; a later navigation solution, which moves entry by seconds at most,
///          does not
class PlannedDeadlines {
  public:
    struct Deadline {
        std::string timepoint;
        Ert latest;  ///< what leaves then or later comes too late
        bool operator==(const Deadline&) const = default;
    };

    /// Without `entry` nothing is planned nor predicted.
    PlannedDeadlines(const dictionary::Dictionary& dictionary, std::optional<Scet> entry, double light_time_s);

    /// Flight has executed it. What changes no offset changes nothing here.
    void executed(const dictionary::Command& command, std::span<const NamedValue> arguments);

    /// Of a command that leaves then; none: nothing that anyone knows the time of waits for it.
    std::optional<Deadline> of(const dictionary::Command& command, std::span<const NamedValue> arguments,
                               Ert leaves) const;
    /// Of any that can still leave.
    std::optional<Deadline> next(Ert now) const;
    /// Planned after `now`, and not after what leaves then is there; in their order.
    std::vector<std::string> missed(Ert now, Ert leaves) const;

  private:
    struct Planned {
        std::size_t timepoint = 0;
        Scet at;
    };
    Deadline deadline(const Planned& planned) const;
    const dictionary::Dictionary& timeline() const { return changed_ ? *changed_ : dictionary_; }
    void plan();

    const dictionary::Dictionary& dictionary_;
    std::optional<dictionary::Dictionary>
        changed_;  ///< with the offsets that flight has now; none: those of dictionary_
    std::optional<Scet> entry_;
    std::int64_t light_time_us_;
    std::vector<Planned> planned_, predicted_;  ///< in order of their time; the latter all of which anyone says when
};

}  // namespace aeolis::commands
