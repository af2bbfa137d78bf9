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

/// The latest time at which a command is still of use: the planned time of a timepoint less the light time.
///
/// In       the dictionary's timeline; the entry predicted when the run began      Out   Earth's clock, names of
///          timepoints
/// Rule     A command that changes an offset must arrive before the timepoint it moves; where flight decides that time,
///          the prediction counts (predicted_anchors.csv). Any other command must arrive before the next planned
///          timepoint. Offsets changed in flight count. A later navigation solution, which moves entry by seconds at
///          most, does not
class PlannedDeadlines {
  public:
    struct Deadline {
        std::string timepoint;
        Ert latest;  ///< leaving at this time or later is too late
        bool operator==(const Deadline&) const = default;
    };

    /// Without `entry` nothing is planned or predicted.
    PlannedDeadlines(const dictionary::Dictionary& dictionary, std::optional<Scet> entry, double light_time_s);

    /// Notes a command that flight has executed. Only a change of an offset has an effect.
    void executed(const dictionary::Command& command, std::span<const NamedValue> arguments);

    /// The deadline of a command that would leave at `leaves`; none: it precedes no timepoint of known time.
    std::optional<Deadline> of(const dictionary::Command& command, std::span<const NamedValue> arguments,
                               Ert leaves) const;
    /// The earliest deadline that a command can still meet.
    std::optional<Deadline> next(Ert now) const;
    /// Names of the timepoints planned after `now` that a command leaving at `leaves` would miss, in their order.
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
    std::vector<Planned> planned_,
        predicted_;  ///< in order of time; predicted_ has all whose time is known or predicted
};

}  // namespace aeolis::commands
