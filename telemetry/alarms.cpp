// SPDX-License-Identifier: Apache-2.0
#include "telemetry/alarms.hpp"

#include "telemetry/text.hpp"

#include <algorithm>
#include <utility>

namespace aeolis::telemetry {
namespace {

using dictionary::Severity;

bool breaks(const dictionary::AlarmRange& range, double value) {
    return range.is_below(value) || range.is_above(value);
}

bool holds(const dictionary::EnumAlarm& alarm, double value) {
    return value >= static_cast<double>(alarm.value) && value <= static_cast<double>(alarm.last.value_or(alarm.value));
}

/// Severity of the most severe limit that `value` violates.
Severity worst(const dictionary::Alarms& alarms, double value) {
    Severity worst = Severity::none;
    for (const dictionary::AlarmRange& range : alarms.ranges)
        if (range.severity > worst && breaks(range, value)) worst = range.severity;
    for (const dictionary::EnumAlarm& alarm : alarms.values)
        if (alarm.severity > worst && holds(alarm, value)) worst = alarm.severity;
    return worst;
}

/// The limit that `value` violates, in words: the one of `severity`, or any when that one guards only the other side.
std::string limit_text(const dictionary::Type& type, const dictionary::Alarms& alarms, Severity severity,
                       double value) {
    std::string text;
    for (const dictionary::AlarmRange& range : alarms.ranges) {
        if (!breaks(range, value) || (!text.empty() && range.severity != severity)) continue;
        const bool low = range.is_below(value), at = low ? range.at_below : range.at_above;
        text = std::string{low ? "<" : ">"} + (at ? "= " : " ") + value_text(type, low ? range.below : range.above);
    }
    return text.empty() ? "= " + value_text(type, value) : text;
}

}  // namespace

const char* name_of(Severity severity) {
    switch (severity) {
    case Severity::none: return "none";
    case Severity::watch: return "watch";
    case Severity::warning: return "warning";
    case Severity::distress: return "distress";
    case Severity::critical: return "critical";
    case Severity::severe: return "severe";
    }
    return "";
}

std::string context_text(const dictionary::Dictionary& dictionary,
                         const std::vector<dictionary::Precondition>& context) {
    std::string text;
    for (const dictionary::Precondition& condition : context) {
        const dictionary::Channel& channel = dictionary.channels[condition.channel.value];
        const std::string value = value_text(channel.type, condition.value);
        if (context.size() == 1 && condition.comparison == "==") return value;
        text += (text.empty() ? "" : " and ") + channel.name + " " + condition.comparison + " " + value;
    }
    return text;
}

const dictionary::ContextAlarms* context_in_force(const dictionary::Alarms& alarms,
                                                  const std::vector<std::optional<double>>& latest) {
    const auto holds = [&](const dictionary::Precondition& condition) {
        const auto& value = latest[condition.channel.value];
        return value && condition.holds(*value);
    };
    const auto found = std::ranges::find_if(alarms.contexts,
                                            [&](const auto& each) { return std::ranges::all_of(each.context, holds); });
    return found == alarms.contexts.end() ? nullptr : &*found;
}

bool latches(const dictionary::Alarms& alarms) {
    return alarms.latches || std::ranges::any_of(alarms.contexts, [](const auto& each) { return each.alarms.latches; });
}

AlarmMonitor::AlarmMonitor(const dictionary::Dictionary& dictionary)
    : dictionary_(dictionary), states_(dictionary.channels.size()), latest_(dictionary.channels.size()) {}

void AlarmMonitor::sample(ChannelId channel, double value, Sclk sclk, std::vector<AlarmChange>& out) {
    AEOLIS_CHECK(channel.value < states_.size());
    latest_[channel.value] = value;
    const dictionary::Type& type = dictionary_.channels[channel.value].type;
    if (type.alarms.ranges.empty() && type.alarms.values.empty() && type.alarms.contexts.empty()) return;

    State& state = states_[channel.value];
    const auto* const context = context_in_force(type.alarms, latest_);
    if (context != std::exchange(state.context, context))
        for (Level& level : state.levels) level.violations = level.conformances = 0;
    const dictionary::Alarms& alarms = context != nullptr ? context->alarms : type.alarms;
    const auto broken = static_cast<std::size_t>(worst(alarms, value));
    Severity now = Severity::none;
    for (std::size_t severity = 1; severity < severities; ++severity) {
        Level& level = state.levels[severity];
        const bool violates = broken >= severity;
        level.violations = violates ? std::min(level.violations + 1, alarms.min_violations) : 0;
        level.conformances = violates ? 0 : std::min(level.conformances + 1, alarms.min_conformance);
        if (level.violations == alarms.min_violations) level.stands = true;
        if (level.conformances == alarms.min_conformance) level.stands = false;
        if (level.stands) now = static_cast<Severity>(severity);
    }
    if (now == state.now) return;
    std::string limit;
    if (now != Severity::none) {
        limit = limit_text(type, alarms, now, value);
        if (context != nullptr) limit += " in " + context_text(dictionary_, context->context);
    }
    out.push_back({channel, now, state.now, value, sclk, std::move(limit)});
    state.now = now;
}

Severity AlarmMonitor::severity(ChannelId channel) const {
    AEOLIS_CHECK(channel.value < states_.size());
    return states_[channel.value].now;
}

}  // namespace aeolis::telemetry
