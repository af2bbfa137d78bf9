// SPDX-License-Identifier: Apache-2.0
// Alarms of any mission's types. What is not judged is a finding. The rules of our own are stricter (alarms.cpp).
#include "dictionaries/xtce/alarms.hpp"
#include "dictionaries/xtce/packet_model_reader.hpp"

#include <algorithm>
#include <string_view>

namespace aeolis::dictionary::xtce {
namespace {

constexpr unsigned samples_max = 1'000'000;  // chosen: violations in a row

std::uint32_t samples_of(pugi::xml_node alarm, const char* attribute) {
    return std::clamp(alarm.attribute(attribute).as_uint(1), 1U, samples_max);
}

}  // namespace

void ModelTypes::read_alarms(const Symbol& symbol, PacketType& type) {
    if (const pugi::xml_node alarm = symbol.element.child("DefaultAlarm")) type.alarms = read_alarm(alarm, type);
    const pugi::xml_node list = symbol.element.child("ContextAlarmList");
    if (list) type.context_alarms.clear();
    for (const pugi::xml_node alarm : list.children("ContextAlarm")) {
        auto when = parts_.condition(symbol.scope, alarm.child("ContextMatch"));
        auto alarms = read_alarm(alarm, type);
        if (when.form == Condition::Form::always)
            parts_.report.fault(alarm, "a ContextAlarm without a context is not judged");
        else
            type.context_alarms.push_back({std::move(when), std::move(alarms)});
    }
}

Alarms ModelTypes::read_alarm(pugi::xml_node alarm, const PacketType& type) {
    Alarms alarms;
    alarms.min_violations = samples_of(alarm, "minViolations");
    alarms.min_conformance = samples_of(alarm, "minConformance");
    for (const pugi::xml_node child : alarm.children()) {
        const std::string_view name = child.name();
        if (child.type() != pugi::node_element || name == "ContextMatch" || name == "AncillaryDataSet" ||
            name == "LongDescription")
            continue;
        if (name == "StaticAlarmRanges")
            read_ranges(child, alarms);
        else if (name == "EnumerationAlarmList")
            read_label_alarms(child, type, alarms);
        else
            parts_.report.fault(child, std::string{name} + " of type " + in_quotes(type.name) + " is not judged");
    }
    return alarms;
}

void ModelTypes::read_ranges(pugi::xml_node ranges, Alarms& alarms) {
    for (const pugi::xml_node element : ranges.children()) {
        if (element.type() != pugi::node_element) continue;
        const auto level = std::ranges::find_if(
            alarm_levels, [&](const AlarmLevel& each) { return std::string_view{each.range} == element.name(); });
        const std::string_view form =
            element.attribute("rangeForm").as_string(ranges.attribute("rangeForm").as_string("outside"));
        if (level == alarm_levels.end() || form != "outside") {
            parts_.report.fault(element, std::string{element.name()} + " " + std::string{form} + " is not judged");
            continue;
        }
        AlarmRange range{.severity = level->severity, .below = {}, .above = {}};
        const auto end = [&](const char* inclusive, const char* exclusive, std::optional<double>& at, bool& included) {
            at = parts_.report.number(element, inclusive);
            if (at) return;
            at = parts_.report.number(element, exclusive);
            included = at.has_value();
        };
        end("minInclusive", "minExclusive", range.below, range.at_below);
        end("maxInclusive", "maxExclusive", range.above, range.at_above);
        if (range.below && range.above && *range.below > *range.above)
            parts_.report.fault(element, std::string{element.name()} + ": its least is above its largest");
        else if (range.below || range.above)
            alarms.ranges.push_back(range);
    }
}

void ModelTypes::read_label_alarms(pugi::xml_node list, const PacketType& type, Alarms& alarms) {
    const std::string_view otherwise = list.attribute("defaultAlarmLevel").as_string("normal");
    if (otherwise != "normal") parts_.report.fault(list, "the level of labels that are not named is not judged");
    for (const pugi::xml_node element : list.children("EnumerationAlarm")) {
        const char* attribute = element.attribute("enumerationLabel") ? "enumerationLabel" : "enumerationValue";
        const std::string label = element.attribute(attribute).value();
        const std::string_view word = element.attribute("alarmLevel").value();
        const auto level = std::ranges::find(alarm_levels, word, &AlarmLevel::word);
        const auto before = alarms.values.size();
        if (level != alarm_levels.end())
            for (const PacketType::Label& each : type.labels)
                if (each.label == label) alarms.values.push_back({level->severity, each.first, each.last});
        if (word != "normal" && alarms.values.size() == before)
            parts_.report.fault(element, "the alarm of label " + in_quotes(label) + ", level " +
                                             in_quotes(std::string{word}) + ", is not judged");
    }
}

}  // namespace aeolis::dictionary::xtce
