// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/xtce/packet_model_reader.hpp"
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

/// Rules for the DefaultAlarm of a type of ours: no context, nothing unknown, and each static range lies outside all
/// less severe ones.
void check_default_alarm(pugi::xml_node default_alarm, const Alarms& alarms, Reporter& report);

/// Reads the ContextAlarmList of each channel's type into the channel, by the same rules. Contexts compare other
/// channels.
void read_context_alarms(const Symbols& symbols, ModelTypes& types, Parameters& parameters, Reporter& report);

}  // namespace aeolis::dictionary::xtce
