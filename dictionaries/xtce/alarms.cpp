// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/alarms.hpp"

#include "dictionaries/words.hpp"

#include <algorithm>
#include <limits>
#include <map>

namespace aeolis::dictionary::xtce {
namespace {

constexpr double none_below = -std::numeric_limits<double>::infinity();
constexpr double none_above = std::numeric_limits<double>::infinity();

bool reaches_inside(const AlarmRange& severe, const AlarmRange& mild) {
    return severe.below.value_or(none_below) > mild.below.value_or(none_below) ||
           severe.above.value_or(none_above) < mild.above.value_or(none_above);
}

void read_ranges(pugi::xml_node ranges, Alarms& alarms, Reporter& report) {
    report.expect(ranges, {"WatchRange", "WarningRange", "DistressRange", "CriticalRange", "SevereRange"}, {});
    for (const AlarmLevel& level : alarm_levels) {
        const pugi::xml_node element = ranges.child(level.range);
        if (!element) continue;
        report.expect(element, {}, {"minInclusive", "maxInclusive"});
        AlarmRange range;
        range.severity = level.severity;
        range.below = report.number(element, "minInclusive");
        range.above = report.number(element, "maxInclusive");
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
        const auto level = std::ranges::find(alarm_levels, word, &AlarmLevel::word);
        if (value == type.enumeration.end())
            report.fault(element, "the alarm names " + in_quotes(label) + ", which the enumeration lacks");
        else if (level == alarm_levels.end())
            report.fault(element, "alarm level " + in_quotes(word) + " is unknown");
        else
            alarms.values.push_back({level->severity, value->value});
    }
}

void read_latch(pugi::xml_node set, Alarms& alarms, Reporter& report) {
    report.expect(set, {"AncillaryData"}, {});
    for (const pugi::xml_node data : set.children("AncillaryData")) {
        const std::string name = name_of(data), word = data.text().as_string();
        if (name != "latch")
            report.fault(data, "alarm: ancillary data " + in_quotes(name) + " is unknown, only latch is known");
        else if (word != "true" && word != "false")
            report.fault(data, "alarm: latch " + in_quotes(word) + " is neither true nor false");
        alarms.latches = word == "true";
    }
}

Alarms read_one(pugi::xml_node element, const Type& type, Reporter& report) {
    Alarms alarms;
    report.expect(element, {"AncillaryDataSet", "StaticAlarmRanges", "EnumerationAlarmList", "ContextMatch"},
                  {"name", "shortDescription", "minViolations", "minConformance"});
    const auto samples = [&](const char* attribute) {
        return static_cast<std::uint32_t>(report.integer(element, attribute, 1, 1000000).value_or(1));
    };
    if (element.attribute("minViolations")) alarms.min_violations = samples("minViolations");
    if (element.attribute("minConformance")) alarms.min_conformance = samples("minConformance");
    read_latch(element.child("AncillaryDataSet"), alarms, report);
    read_ranges(element.child("StaticAlarmRanges"), alarms, report);
    read_labels(element.child("EnumerationAlarmList"), type, alarms, report);
    return alarms;
}

std::vector<ContextAlarms> read_contexts(const Symbols& symbols, const Parameters& parameters, const Symbol& of,
                                         const Type& type, Reporter& report) {
    const std::string name = "type " + in_quotes(type.name);
    const pugi::xml_node list = of.element.child("ContextAlarmList");
    report.expect(list, {"ContextAlarm"}, {});
    std::vector<ContextAlarms> contexts;
    for (const pugi::xml_node element : list.children("ContextAlarm")) {
        auto& [context, alarms] = contexts.emplace_back();
        alarms = read_one(element, type, report);
        const pugi::xml_node match = element.child("ContextMatch");
        report.expect(match, {"Comparison", "ComparisonList"}, {});
        report.expect(match.child("ComparisonList"), {"Comparison"}, {});
        for (const pugi::xml_node all : {match, match.child("ComparisonList")})
            for (const pugi::xml_node comparison : all.children("Comparison"))
                if (auto condition = read_comparison(symbols, parameters, of.scope, comparison, name, report))
                    context.push_back(std::move(*condition));
        if (!match.first_child())
            report.fault(match ? match : element, name + ": a context alarm without ContextMatch");
    }
    return contexts;
}

}  // namespace

Alarms read_alarms(pugi::xml_node default_alarm, const Type& type, Reporter& report) {
    if (!default_alarm) return {};
    if (const pugi::xml_node match = default_alarm.child("ContextMatch"))
        report.fault(match, "DefaultAlarm: a context belongs into ContextAlarmList");
    return read_one(default_alarm, type, report);
}

void read_context_alarms(const Symbols& symbols, Parameters& parameters, Reporter& report) {
    std::map<std::string, std::vector<ContextAlarms>> by_type;  // each type is read, and its faults reported, once
    for (const auto& [path, parameter] : parameters.by_path) {
        if (!parameter.channel || !parameter.type) continue;
        const Symbol* symbol = symbols.find(Kind::parameter_type, path.substr(0, path.rfind('/')),
                                            parameter.element.attribute("parameterTypeRef").value());
        const auto [contexts, added] = by_type.try_emplace(symbol->path);
        if (added) contexts->second = read_contexts(symbols, parameters, *symbol, *parameter.type, report);
        parameters.channels[parameter.channel->value].type.alarms.contexts = contexts->second;
    }
}

}  // namespace aeolis::dictionary::xtce
