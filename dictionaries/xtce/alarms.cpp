// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/alarms.hpp"

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

void check_ranges(pugi::xml_node ranges, const Alarms& alarms, Reporter& report) {
    report.expect(ranges, {"WatchRange", "WarningRange", "DistressRange", "CriticalRange", "SevereRange"}, {});
    const AlarmRange* milder = nullptr;
    for (const AlarmLevel& level : alarm_levels) {
        const pugi::xml_node element = ranges.child(level.range);
        if (element) report.expect(element, {}, {"minInclusive", "maxInclusive"});
        const auto range = std::ranges::find(alarms.ranges, level.severity, &AlarmRange::severity);
        if (range == alarms.ranges.end()) continue;
        if (milder != nullptr && reaches_inside(*range, *milder))
            report.fault(element, std::string{level.range} + " is not nested: it reaches inside the less severe range");
        milder = &*range;
    }
}

void check_alarm(pugi::xml_node element, const Alarms& alarms, Reporter& report) {
    report.expect(element, {"AncillaryDataSet", "StaticAlarmRanges", "EnumerationAlarmList", "ContextMatch"},
                  {"name", "shortDescription", "minViolations", "minConformance"});
    const pugi::xml_node set = element.child("AncillaryDataSet"), labels = element.child("EnumerationAlarmList");
    report.expect(set, {"AncillaryData"}, {});
    for (const pugi::xml_node data : set.children("AncillaryData"))
        if (const std::string name = name_of(data); name != "latch")
            report.fault(data, "alarm: ancillary data " + in_quotes(name) + " is unknown, only latch is known");
    check_ranges(element.child("StaticAlarmRanges"), alarms, report);
    report.expect(labels, {"EnumerationAlarm"}, {});
    for (const pugi::xml_node label : labels.children("EnumerationAlarm"))
        report.expect(label, {}, {"alarmLevel", "enumerationLabel"});
}

std::vector<ContextAlarms> read_contexts(const Symbols& symbols, const Parameters& parameters, const Symbol& of,
                                         const PacketType& type, Reporter& report) {
    const std::string name = "type " + in_quotes(type.name);
    const pugi::xml_node list = of.element.child("ContextAlarmList");
    report.expect(list, {"ContextAlarm"}, {});
    std::vector<ContextAlarms> contexts;
    for (const pugi::xml_node element : list.children("ContextAlarm")) {
        auto& [context, alarms] = contexts.emplace_back();
        alarms = read_alarm(element, type, report);
        check_alarm(element, alarms, report);
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

void check_default_alarm(pugi::xml_node default_alarm, const Alarms& alarms, Reporter& report) {
    if (!default_alarm) return;
    if (const pugi::xml_node match = default_alarm.child("ContextMatch"))
        report.fault(match, "DefaultAlarm: a context belongs into ContextAlarmList");
    check_alarm(default_alarm, alarms, report);
}

void read_context_alarms(const Symbols& symbols, ModelTypes& types, Parameters& parameters, Reporter& report) {
    std::map<std::string, std::vector<ContextAlarms>> by_type;  // each type is read, and its faults reported, once
    for (const auto& [path, parameter] : parameters.by_path) {
        if (!parameter.channel || !parameter.type) continue;
        const Symbol* symbol = symbols.find(Kind::parameter_type, path.substr(0, path.rfind('/')),
                                            parameter.element.attribute("parameterTypeRef").value());
        const auto [contexts, added] = by_type.try_emplace(symbol->path);
        if (added)
            contexts->second = read_contexts(symbols, parameters, *symbol, types.types[types.of(*symbol)], report);
        parameters.channels[parameter.channel->value].type.alarms.contexts = contexts->second;
    }
}

}  // namespace aeolis::dictionary::xtce
