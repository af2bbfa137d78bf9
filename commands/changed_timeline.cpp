// SPDX-License-Identifier: Apache-2.0
#include "commands/changed_timeline.hpp"

#include "commands/timeline_change.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace aeolis::commands {
namespace {

std::string constraint_text(const dictionary::Dictionary& dictionary, const dictionary::ConstraintRow& row) {
    return fmt::format("{} to {} (constraints.csv:{})", moment_text(dictionary, row.from),
                       moment_text(dictionary, row.to), row.line);
}

}  // namespace

TimelineChanges changes_of(std::vector<TimelineCommand> commands) {
    TimelineChanges changes;
    for (auto& command : commands) {
        if (!changes_offsets(command.name)) continue;
        if (command.failed)
            ++changes.undone;
        else
            (command.left ? changes.left : changes.waiting).push_back(std::move(command));
    }
    std::ranges::sort(changes.left, {}, &TimelineCommand::left);
    std::ranges::sort(changes.waiting, {}, &TimelineCommand::number);
    return changes;
}

Result<void> ChangedTimeline::change(const std::string& command, std::span<const NamedValue> given) {
    const auto* const known = dictionary_.command(command);
    if (known == nullptr) return Error{"the dictionary has no command " + command};
    const auto packet = encode(*known, given, 0);
    if (!packet) return packet.error();
    TimelineCommand encoded;
    encoded.name = command;
    encoded.packet = *packet;
    change(encoded);
    return {};
}

void ChangedTimeline::change(const TimelineCommand& command) {
    const auto* const known = dictionary_.command(command.name);
    if (known == nullptr) return;
    const auto arguments = decode(*known, command.packet);
    if (!arguments) return;
    apply_offsets(dictionary_, command.name, *arguments);
    key_ += command.name + ' ' + arguments_text(*arguments) + '\n';
}

Result<std::string> verdict_on(const dictionary::Dictionary& changed, const dictionary::TimelineAnalysis& analysis) {
    if (!analysis.contradiction.empty() || !analysis.admits_schedule)
        return Error{"the changed timeline cannot be flown: its offsets contradict what constraints.csv gives (aeolis "
                     "timeline analyse)"};
    for (const auto& bound : analysis.bounds) {
        if (bound.proof == dictionary::Proof::proven) continue;
        const auto& row = changed.constraints[bound.constraint];
        const auto limit = bound.is_minimum ? row.minimum_s : row.maximum_s;
        return Error{fmt::format("the changed timeline breaks a constraint: {}, {} {} s, {}: {}",
                                 constraint_text(changed, row), bound.is_minimum ? "at least" : "at most",
                                 limit.value_or(0.0),
                                 bound.slack_s ? fmt::format("missed by {:.3f} s", -*bound.slack_s) : "without a bound",
                                 row.note.empty() ? row.source : row.note)};
    }
    return fmt::format("all {} bounds of constraints.csv hold on the changed timeline", analysis.bounds.size());
}

}  // namespace aeolis::commands
