// SPDX-License-Identifier: Apache-2.0
#include "server/gateway/timeline_check.hpp"

#include "commands/encoder.hpp"
#include "commands/timeline_change.hpp"
#include "dictionaries/analysis/timeline_analysis.hpp"
#include "server/archive/items.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace aeolis::server {
namespace {

bool failed(const v1::CommandHistory& command) {
    // That it could not be verified does not undo it.
    return std::ranges::any_of(command.stages(), [](const v1::Item& item) {
        return item.command_stage().status() == "failed" && item.command_stage().stage() != "verified";
    });
}

std::string text_of(const dictionary::Dictionary& dictionary, const dictionary::ConstraintRow& row) {
    return fmt::format("{} to {} (constraints.csv:{})", moment_text(dictionary, row.from),
                       moment_text(dictionary, row.to), row.line);
}

Result<std::string> words_of(const dictionary::Dictionary& changed, const dictionary::TimelineAnalysis& analysis) {
    if (!analysis.contradiction.empty() || !analysis.admits_schedule)
        return Error{"the changed timeline cannot be flown: its offsets contradict what constraints.csv gives (aeolis "
                     "timeline analyse)"};
    for (const auto& bound : analysis.bounds) {
        if (bound.proof == dictionary::Proof::proven) continue;
        const auto& row = changed.constraints[bound.constraint];
        const auto limit = bound.is_minimum ? row.minimum_s : row.maximum_s;
        return Error{fmt::format("the changed timeline breaks a constraint: {}, {} {} s, {}: {}", text_of(changed, row),
                                 bound.is_minimum ? "at least" : "at most", limit.value_or(0.0),
                                 bound.slack_s ? fmt::format("missed by {:.3f} s", -*bound.slack_s) : "without a bound",
                                 row.note.empty() ? row.source : row.note)};
    }
    return fmt::format("all {} bounds of constraints.csv hold on the changed timeline", analysis.bounds.size());
}

/// The timeline with the changes made so far, and a text that tells it from any other.
struct ChangedTimeline {
    dictionary::Dictionary dictionary;
    std::string key;

    void change(const std::string& command, std::span<const commands::NamedValue> arguments) {
        commands::apply_offsets(dictionary, command, arguments);
        key += command + ' ' + commands::arguments_text(arguments) + '\n';
    }
    /// Nothing where it is of another dictionary.
    void change(const v1::CommandHistory& command) {
        const auto* const known = dictionary.command(command.name());
        const auto arguments =
            known == nullptr ? Error{"unknown"} : commands::decode(*known, archive::octets_of_hex(command.octets()));
        if (arguments) change(command.name(), *arguments);
    }
};

/// Those that change offsets and have not failed: what left in the order in which it did, then what waits by its
/// number.
struct Changes {
    std::vector<const v1::CommandHistory*> left, waiting;
};

Changes changes_of(const v1::CommandList& list) {
    Changes changes;
    std::vector<std::pair<std::uint64_t, const v1::CommandHistory*>> left;
    for (const auto& command : list.commands()) {
        if (!commands::changes_offsets(command.name()) || failed(command)) continue;
        const v1::Item* released = nullptr;
        for (const auto& stage : command.stages())
            if (stage.command_stage().stage() == "released") released = &stage;
        if (released != nullptr && released->command_stage().status() == "ok")
            left.emplace_back(released->seq(), &command);
        else
            changes.waiting.push_back(&command);
    }
    std::ranges::sort(left);
    for (const auto& [seq, command] : left) changes.left.push_back(command);
    std::ranges::sort(changes.waiting, {}, [](const auto* command) { return command->command(); });
    return changes;
}

}  // namespace

bool changes_timeline(const v1::CommandRequest& request) {
    return request.action().empty() && commands::changes_offsets(request.command());
}

Result<std::string> TimelineCheck::check(const v1::CommandList& before, std::span<const v1::CommandRequest> asked,
                                         bool only_check, const Stop& stop) {
    ChangedTimeline timeline{dictionary_, ""};
    const auto changes = changes_of(before);
    for (const auto& commands : {changes.left, changes.waiting})
        for (const auto* command : commands) timeline.change(*command);
    for (const auto& request : asked) {
        const auto* const known = dictionary_.command(request.command());
        if (known == nullptr || !changes_timeline(request)) continue;
        std::vector<commands::NamedValue> given;
        for (const auto& argument : request.arguments()) given.push_back({argument.name(), argument.value()});
        const auto packet = commands::encode(*known, given, 0);
        if (!packet) continue;                                     // the gateway refuses it, and says why
        const auto arguments = commands::decode(*known, *packet);  // with defaults
        if (!arguments) return arguments.error();
        timeline.change(request.command(), *arguments);
    }
    return analysed(timeline.key, timeline.dictionary, only_check, stop);
}

TimelineCheck::Look TimelineCheck::look_again(const v1::CommandList& before, const Stop& stop) {
    Look look;
    look.undone =
        static_cast<std::size_t>(std::ranges::count_if(before.commands(), [](const v1::CommandHistory& command) {
            return commands::changes_offsets(command.name()) && failed(command);
        }));
    ChangedTimeline timeline{dictionary_, ""};
    const auto changes = changes_of(before);
    for (const auto* command : changes.left) timeline.change(*command);
    for (const auto* command : changes.waiting) {
        auto with = timeline;
        with.change(*command);
        const auto says = analysed(with.key, with.dictionary, false, stop);
        if (!says && says.error().internal) {
            look.not_known = says.error().message;
            return look;
        }
        look.known.push_back({command->command(), !says, says ? *says : says.error().message});
        if (says) timeline = std::move(with);
    }
    return look;
}

Result<std::string> TimelineCheck::analysed(const std::string& key, const dictionary::Dictionary& changed,
                                            bool only_check, const Stop& stop) {
    const auto known = [&]() -> std::optional<Result<std::string>> {
        const std::scoped_lock lock{mutex_};
        const auto found = answers_.find(key);
        return found == answers_.end() ? std::nullopt : std::optional{found->second};
    };
    if (const auto answer = known()) return *answer;
    const bool under_way = [&] {
        const std::scoped_lock lock{mutex_};
        return analysed_now_ == key;
    }();
    const std::unique_lock turn{analysing_, only_check && !under_way ? std::chrono::milliseconds{0} : turn_max};
    if (!turn.owns_lock())
        return Error{.message = "the timeline is analysed for another change: send again in a moment",
                     .internal = true};
    if (const auto answer = known()) return *answer;
    {
        const std::scoped_lock lock{mutex_};
        analysed_now_ = key;
    }
    const auto analysis = dictionary::analyse_bounds(changed, stop);
    if (analysis.stopped)
        return Error{.message = "the analysis of the changed timeline did not end in its time, so that nobody knows "
                                "whether its constraints hold: "
                                "send it again, or change less at once",
                     .internal = true};
    const auto answer = words_of(changed, analysis);
    const std::scoped_lock lock{mutex_};
    if (answers_.size() >= answers_max) answers_.clear();
    answers_.emplace(key, answer);
    return answer;
}

}  // namespace aeolis::server
