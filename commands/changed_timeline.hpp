// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands/encoder.hpp"
#include "common/result.hpp"
#include "dictionaries/analysis/timeline_analysis.hpp"
#include "dictionaries/dictionary.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace aeolis::commands {

/// The part of a run's command that matters to the timeline.
struct TimelineCommand {
    std::uint64_t number = 0;
    std::string name;
    std::vector<std::uint8_t> packet;
    bool failed = false;                ///< had no effect
    std::optional<std::uint64_t> left;  ///< place in the order of release; none: not yet released
};

/// Commands that change offsets: the released ones in the order of release, the waiting ones by number.
struct TimelineChanges {
    std::vector<TimelineCommand> left, waiting;
    std::size_t undone = 0;  ///< number of failed changes, which are in neither list
};
TimelineChanges changes_of(std::vector<TimelineCommand> commands);

/// The timeline with the changes so far. A value.
class ChangedTimeline {
  public:
    explicit ChangedTimeline(const dictionary::Dictionary& dictionary) : dictionary_(dictionary) {}

    /// Defaults stand for arguments not given. Fails when they cannot be encoded, with the reason.
    Result<void> change(const std::string& command, std::span<const NamedValue> given);
    /// Does nothing when the command is of another dictionary.
    void change(const TimelineCommand& command);

    const dictionary::Dictionary& dictionary() const { return dictionary_; }
    const std::string& key() const { return key_; }  ///< differs between any two changed timelines of one dictionary

  private:
    dictionary::Dictionary dictionary_;
    std::string key_;
};

/// Returns the verdict of a changed timeline's analysis. Fails with the first constraint that no longer holds. R19
Result<std::string> verdict_on(const dictionary::Dictionary& changed, const dictionary::TimelineAnalysis& analysis);

}  // namespace aeolis::commands
