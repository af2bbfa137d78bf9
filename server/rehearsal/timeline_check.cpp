// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/timeline_check.hpp"

#include "commands/changed_timeline.hpp"
#include "commands/timeline_change.hpp"
#include "server/archive/items.hpp"

#include <utility>

namespace aeolis::server {
namespace {

commands::TimelineChanges changes_of(const v1::CommandList& list) {
    std::vector<commands::TimelineCommand> all;
    for (const auto& history : list.commands()) {
        auto& command = all.emplace_back();
        command.number = history.command();
        command.name = history.name();
        command.packet = archive::octets_of_hex(history.octets());
        for (const auto& item : history.stages()) {
            const auto& stage = item.command_stage();
            // A failed verification does not undo the change.
            command.failed = command.failed || (stage.status() == v1::CommandStage::failed &&
                                                stage.stage() != v1::CommandStage::verified);
            if (stage.stage() == v1::CommandStage::released)
                command.left = stage.status() == v1::CommandStage::ok ? std::optional{item.seq()} : std::nullopt;
        }
    }
    return commands::changes_of(std::move(all));
}

}  // namespace

bool changes_timeline(const v1::CommandRequest& request) {
    return request.action().empty() && commands::changes_offsets(request.command());
}

Result<std::string> TimelineCheck::check(const v1::CommandList& before, std::span<const v1::CommandRequest> asked,
                                         bool only_check, const Stop& stop) {
    commands::ChangedTimeline timeline{dictionary_};
    const auto changes = changes_of(before);
    for (const auto* commands : {&changes.left, &changes.waiting})
        for (const auto& command : *commands) timeline.change(command);
    for (const auto& request : asked) {
        if (!changes_timeline(request)) continue;
        std::vector<commands::NamedValue> given;
        for (const auto& argument : request.arguments()) given.push_back({argument.name(), argument.value()});
        static_cast<void>(timeline.change(request.command(), given));  // the gateway refuses it, with the reason
    }
    return analysed(timeline.key(), timeline.dictionary(), only_check, stop);
}

TimelineCheck::Reanalysis TimelineCheck::reanalyse(const v1::CommandList& before, const Stop& stop) {
    Reanalysis reanalysis;
    commands::ChangedTimeline timeline{dictionary_};
    const auto changes = changes_of(before);
    reanalysis.undone = changes.undone;
    for (const auto& command : changes.left) timeline.change(command);
    for (const auto& command : changes.waiting) {
        auto with = timeline;
        with.change(command);
        const auto says = analysed(with.key(), with.dictionary(), false, stop);
        if (!says && says.error().internal) {
            reanalysis.not_known = says.error().message;
            return reanalysis;
        }
        reanalysis.known.push_back({command.number, !says, says ? *says : says.error().message});
        if (says) timeline = std::move(with);
    }
    return reanalysis;
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
    const auto answer = commands::verdict_on(changed, analysis);
    const std::scoped_lock lock{mutex_};
    if (answers_.size() >= answers_max) answers_.clear();
    answers_.emplace(key, answer);
    return answer;
}

}  // namespace aeolis::server
