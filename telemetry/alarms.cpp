#include "telemetry/alarms.hpp"

#include "telemetry/text.hpp"

#include <algorithm>

namespace aeolis::telemetry {
namespace {

using dictionary::Severity;

bool breaks(const dictionary::AlarmRange& range, double value) {
    return (range.below && value < *range.below) || (range.above && value > *range.above);
}

/// Of the most severe limit that `value` breaks.
Severity worst(const dictionary::Type& type, double value) {
    Severity worst = Severity::none;
    for (const dictionary::AlarmRange& range : type.alarms.ranges)
        if (range.severity > worst && breaks(range, value)) worst = range.severity;
    for (const dictionary::EnumAlarm& alarm : type.alarms.values)
        if (alarm.severity > worst && value == static_cast<double>(alarm.value)) worst = alarm.severity;
    return worst;
}

/// The limit that `value` breaks, in words: the one of `severity`, or, where that one guards the other side only, any.
std::string limit_text(const dictionary::Type& type, Severity severity, double value) {
    std::string text;
    for (const dictionary::AlarmRange& range : type.alarms.ranges) {
        if (!breaks(range, value) || (!text.empty() && range.severity != severity)) continue;
        const bool low = range.below && value < *range.below;
        text = (low ? "< " : "> ") + value_text(type, low ? range.below : range.above);
    }
    return text.empty() ? "= " + value_text(type, value) : text;
}

} // namespace

const char* name_of(Severity severity) {
    switch (severity) {
    case Severity::none:
        return "none";
    case Severity::watch:
        return "watch";
    case Severity::warning:
        return "warning";
    case Severity::distress:
        return "distress";
    case Severity::critical:
        return "critical";
    case Severity::severe:
        return "severe";
    }
    return "";
}

AlarmMonitor::AlarmMonitor(const dictionary::Dictionary& dictionary)
    : dictionary_(dictionary), states_(dictionary.channels.size()) {}

void AlarmMonitor::sample(ChannelId channel, double value, Sclk sclk, std::vector<AlarmChange>& out) {
    AEOLIS_CHECK(channel.value < states_.size());
    const dictionary::Type& type = dictionary_.channels[channel.value].type;
    if (type.alarms.ranges.empty() && type.alarms.values.empty()) return;

    State& state = states_[channel.value];
    const auto broken = static_cast<std::size_t>(worst(type, value));
    const std::uint32_t needed = std::max(type.alarms.min_violations, 1U);
    Severity now = Severity::none;
    for (std::size_t level = 1; level < severities; ++level) {
        std::uint32_t& in_a_row = state.in_a_row[level];
        in_a_row = broken < level ? 0 : std::min(in_a_row + 1, needed);
        if (in_a_row == needed) now = static_cast<Severity>(level);
    }
    if (now == state.now) return;
    out.push_back(
        {channel, now, state.now, value, sclk, now == Severity::none ? std::string{} : limit_text(type, now, value)});
    state.now = now;
}

Severity AlarmMonitor::severity(ChannelId channel) const {
    AEOLIS_CHECK(channel.value < states_.size());
    return states_[channel.value].now;
}

} // namespace aeolis::telemetry
