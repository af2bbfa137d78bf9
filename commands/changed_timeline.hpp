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

/// A command of a run, as far as it matters to the timeline.
struct TimelineCommand {
    std::uint64_t number = 0;
    std::string name;
    std::vector<std::uint8_t> packet;
    bool failed = false;                ///< it came to nothing
    std::optional<std::uint64_t> left;  ///< place in the order of release; none: it waits
};

/// Those that change offsets: what left in the order of release, what waits by its number.
struct TimelineChanges {
    std::vector<TimelineCommand> left, waiting;
    std::size_t undone = 0;  ///< that came to nothing, and are in neither
};
TimelineChanges changes_of(std::vector<TimelineCommand> commands);

/// The timeline with the changes made so far. A value.
class ChangedTimeline {
  public:
    explicit ChangedTimeline(const dictionary::Dictionary& dictionary) : dictionary_(dictionary) {}

    void change(const std::string& command, std::span<const NamedValue> arguments);
    /// Nothing where it is of another dictionary.
    void change(const TimelineCommand& command);

    const dictionary::Dictionary& dictionary() const { return dictionary_; }
    const std::string& key() const { return key_; }  ///< tells it from any other of the same dictionary

  private:
    dictionary::Dictionary dictionary_;
    std::string key_;
};

/// What the analysis of a changed timeline says; an Error names the first constraint that no longer holds. R19
Result<std::string> verdict_on(const dictionary::Dictionary& changed, const dictionary::TimelineAnalysis& analysis);

}  // namespace aeolis::commands
