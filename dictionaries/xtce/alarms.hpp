// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/xtce/parameters.hpp"

#include <array>
#include <string_view>

namespace aeolis::dictionary::xtce {

/// A level of alarm: the element of its range, and its word. [xtce-1.2]
struct AlarmLevel {
    const char* range;
    std::string_view word;
    Severity severity;
};
inline constexpr std::array alarm_levels{
    AlarmLevel{"WatchRange", "watch", Severity::watch}, AlarmLevel{"WarningRange", "warning", Severity::warning},
    AlarmLevel{"DistressRange", "distress", Severity::distress},
    AlarmLevel{"CriticalRange", "critical", Severity::critical}, AlarmLevel{"SevereRange", "severe", Severity::severe}};

/// Reads the DefaultAlarm of a type; an absent element gives no alarms.
/// It has static ranges, each outside all less severe ones, or labels of an enumeration. minViolations and
/// minConformance count consecutive samples. AncillaryData "latch" with the content "true" makes the alarm stay until
/// it is reset.
Alarms read_alarms(pugi::xml_node default_alarm, const Type& type, Reporter& report);

/// Reads the ContextAlarmList of each channel's type into the channel. Contexts compare other channels.
void read_context_alarms(const Symbols& symbols, Parameters& parameters, Reporter& report);

}  // namespace aeolis::dictionary::xtce
