#include "dictionaries/xtce/alarms.hpp"

#include "dictionaries/words.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace aeolis::dictionary::xtce {
namespace {

struct Level {
    const char* range;
    const char* word;
    Severity severity;
};
constexpr std::array levels{
    Level{"WatchRange", "watch", Severity::watch}, Level{"WarningRange", "warning", Severity::warning},
    Level{"DistressRange", "distress", Severity::distress}, Level{"CriticalRange", "critical", Severity::critical},
    Level{"SevereRange", "severe", Severity::severe}};

constexpr double none_below = -std::numeric_limits<double>::infinity();
constexpr double none_above = std::numeric_limits<double>::infinity();

bool reaches_inside(const AlarmRange& severe, const AlarmRange& mild) {
    return severe.below.value_or(none_below) > mild.below.value_or(none_below) ||
           severe.above.value_or(none_above) < mild.above.value_or(none_above);
}

void read_ranges(pugi::xml_node ranges, Alarms& alarms, Reporter& report) {
    report.expect(ranges, {"WatchRange", "WarningRange", "DistressRange", "CriticalRange", "SevereRange"}, {});
    for (const Level& level : levels) {
        const pugi::xml_node element = ranges.child(level.range);
        if (!element) continue;
        report.expect(element, {}, {"minInclusive", "maxInclusive"});
        const AlarmRange range{level.severity, report.number(element, "minInclusive"),
                               report.number(element, "maxInclusive")};
        if (range.below && range.above && *range.below > *range.above)
            report.fault(element, std::string{level.range} + ": minInclusive is above maxInclusive");
        else if (!alarms.ranges.empty() && reaches_inside(range, alarms.ranges.back()))
            report.fault(element, std::string{level.range} + " is not nested: it reaches inside the less severe range");
        alarms.ranges.push_back(range);
    }
}

void read_labels(pugi::xml_node list, const Type& type, Alarms& alarms, Reporter& report) {
    report.expect(list, {"EnumerationAlarm"}, {});
    for (const pugi::xml_node element : list.children("EnumerationAlarm")) {
        report.expect(element, {}, {"alarmLevel", "enumerationLabel"});
        const std::string label = element.attribute("enumerationLabel").value();
        const std::string word = element.attribute("alarmLevel").value();
        const auto value = std::ranges::find(type.enumeration, label, &EnumValue::label);
        const auto level = std::ranges::find(levels, word, [](const Level& l) { return std::string{l.word}; });
        if (value == type.enumeration.end())
            report.fault(element, "the alarm names " + in_quotes(label) + ", which the enumeration lacks");
        else if (level == levels.end())
            report.fault(element, "alarm level " + in_quotes(word) + " is unknown");
        else
            alarms.values.push_back({level->severity, value->value});
    }
}

} // namespace

Alarms read_alarms(pugi::xml_node default_alarm, const Type& type, Reporter& report) {
    Alarms alarms;
    if (!default_alarm) return alarms;
    report.expect(default_alarm, {"StaticAlarmRanges", "EnumerationAlarmList"}, {"minViolations"});
    alarms.min_violations =
        static_cast<std::uint32_t>(report.integer(default_alarm, "minViolations", 1, 1000000).value_or(1));
    read_ranges(default_alarm.child("StaticAlarmRanges"), alarms, report);
    read_labels(default_alarm.child("EnumerationAlarmList"), type, alarms, report);
    return alarms;
}

} // namespace aeolis::dictionary::xtce
