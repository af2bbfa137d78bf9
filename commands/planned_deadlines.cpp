// SPDX-License-Identifier: Apache-2.0
#include "commands/planned_deadlines.hpp"

#include "commands/timeline_change.hpp"
#include "dictionaries/timeline_plan.hpp"

#include <algorithm>

namespace aeolis::commands {

PlannedDeadlines::PlannedDeadlines(const dictionary::Dictionary& dictionary, std::optional<Scet> entry,
                                   double light_time_s)
    : dictionary_(dictionary), entry_(entry), light_time_us_(static_cast<std::int64_t>(light_time_s * 1.0e6)) {
    plan();
}

void PlannedDeadlines::plan() {
    planned_.clear();
    predicted_.clear();
    if (!entry_) return;
    const auto at = [&](double e_s) { return Scet{entry_->microseconds + static_cast<std::int64_t>(e_s * 1.0e6)}; };
    const auto planned_s = dictionary::planned_from_entry_s(timeline());
    const auto predicted_s = dictionary::predicted_from_entry_s(timeline(), timeline().predicted_anchor_e_s, {});
    for (std::size_t i = 0; i < planned_s.size(); ++i) {
        if (planned_s[i]) planned_.push_back({i, at(*planned_s[i])});
        if (const auto e_s = planned_s[i] ? planned_s[i] : predicted_s[i]) predicted_.push_back({i, at(*e_s)});
    }
    std::ranges::stable_sort(planned_, {}, &Planned::at);
    std::ranges::stable_sort(predicted_, {}, &Planned::at);
}

void PlannedDeadlines::executed(const dictionary::Command& command, std::span<const NamedValue> arguments) {
    if (!changes_offsets(command.name)) return;
    if (!changed_) changed_ = dictionary_;
    apply_offsets(*changed_, command.name, arguments);
    plan();
}

PlannedDeadlines::Deadline PlannedDeadlines::deadline(const Planned& planned) const {
    return {dictionary_.timeline[planned.timepoint].name, Ert{planned.at.microseconds - light_time_us_}};
}

std::optional<PlannedDeadlines::Deadline> PlannedDeadlines::next(Ert now) const {
    const Scet there{now.microseconds + light_time_us_};
    const auto after = std::ranges::upper_bound(planned_, there, {}, &Planned::at);
    return after == planned_.end() ? std::nullopt : std::optional{deadline(*after)};
}

std::optional<PlannedDeadlines::Deadline>
PlannedDeadlines::of(const dictionary::Command& command, std::span<const NamedValue> arguments, Ert leaves) const {
    const auto moved = moved_timepoints(dictionary_, command.name, arguments);
    if (moved.empty()) return next(leaves);
    const auto first = std::ranges::find_if(
        predicted_, [&](const Planned& each) { return std::ranges::find(moved, each.timepoint) != moved.end(); });
    return first == predicted_.end() ? std::nullopt : std::optional{deadline(*first)};
}

std::vector<std::string> PlannedDeadlines::missed(Ert now, Ert leaves) const {
    const Scet there{leaves.microseconds + light_time_us_};
    std::vector<std::string> names;
    for (const auto& each : planned_)
        if (each.at > Scet{now.microseconds} && each.at <= there)
            names.push_back(dictionary_.timeline[each.timepoint].name);
    return names;
}

}  // namespace aeolis::commands
