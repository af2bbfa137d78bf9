// SPDX-License-Identifier: Apache-2.0
// Alarms of any mission's types. What is not judged is a finding. The rules for our own are in alarms.cpp.
#include "dictionaries/xtce/alarms.hpp"
#include "dictionaries/xtce/packet_model_reader.hpp"

#include <algorithm>
#include <string_view>

namespace aeolis::dictionary::xtce {
namespace {

constexpr std::int64_t samples_max = 1'000'000;  // chosen: violations in a row

class AlarmReader {
  public:
    AlarmReader(const PacketType& type, Reporter& report) : type_(type), report_(report) {}

    Alarms read(pugi::xml_node alarm) {
        const auto samples = [&](const char* attribute) {
            return static_cast<std::uint32_t>(report_.integer(alarm, attribute, 1, samples_max).value_or(1));
        };
        alarms_.min_violations = samples("minViolations");
        alarms_.min_conformance = samples("minConformance");
        for (const pugi::xml_node child : alarm.children()) {
            const std::string_view name = child.name();
            if (child.type() != pugi::node_element || name == "ContextMatch" || name == "LongDescription") continue;
            if (name == "StaticAlarmRanges")
                read_ranges(child);
            else if (name == "EnumerationAlarmList")
                read_labels(child);
            else if (name == "AncillaryDataSet")
                read_latch(child);
            else
                report_.fault(child, std::string{name} + " of type " + in_quotes(type_.name) + " is not judged");
        }
        std::ranges::stable_sort(alarms_.ranges, {}, &AlarmRange::severity);
        if (report_.flag_or(alarm, "disabled", false).value_or(false))
            return {};  // the file switches it off [xtce-1.3]
        return std::move(alarms_);
    }

  private:
    void read_ranges(pugi::xml_node ranges) {
        for (const pugi::xml_node element : ranges.children()) {
            if (element.type() != pugi::node_element) continue;
            const auto level = std::ranges::find_if(
                alarm_levels, [&](const AlarmLevel& each) { return std::string_view{each.range} == element.name(); });
            const std::string_view form =
                element.attribute("rangeForm").as_string(ranges.attribute("rangeForm").as_string("outside"));
            if (level == alarm_levels.end() || form != "outside") {
                report_.fault(element, std::string{element.name()} + " " + std::string{form} + " is not judged");
                continue;
            }
            AlarmRange range{.severity = level->severity, .below = {}, .above = {}};
            read_end(element, "min", range.below, range.at_below);
            read_end(element, "max", range.above, range.at_above);
            if (range.below && range.above && *range.below > *range.above)
                report_.fault(element, std::string{element.name()} +
                                           (range.at_below ? ": minExclusive" : ": minInclusive") + " is above " +
                                           (range.at_above ? "maxExclusive" : "maxInclusive"));
            else if (range.below || range.above)
                alarms_.ranges.push_back(range);
        }
    }

    /// The end "min" or "max"; an exclusive one belongs to the alarm.
    void read_end(pugi::xml_node element, const std::string& end, std::optional<double>& at, bool& included) {
        at = report_.number(element, (end + "Inclusive").c_str());
        if (at) return;
        at = report_.number(element, (end + "Exclusive").c_str());
        included = at.has_value();
    }

    void read_labels(pugi::xml_node list) {
        const std::string_view otherwise = list.attribute("defaultAlarmLevel").as_string("normal");
        if (otherwise != "normal") report_.fault(list, "the level of labels that are not named is not judged");
        for (const pugi::xml_node element : list.children("EnumerationAlarm")) {
            const char* attribute = element.attribute("enumerationLabel") ? "enumerationLabel" : "enumerationValue";
            const std::string label = element.attribute(attribute).value();
            const std::string_view word = element.attribute("alarmLevel").value();
            const auto level = std::ranges::find(alarm_levels, word, &AlarmLevel::word);
            const auto before = alarms_.values.size();
            for (const PacketType::Label& each : type_.labels)
                if (each.label == label && level != alarm_levels.end())
                    alarms_.values.push_back({level->severity, each.first,
                                              each.last == each.first ? std::nullopt : std::optional{each.last}});
            if (word == "normal") continue;
            if (level == alarm_levels.end())
                report_.fault(element, "alarm level " + in_quotes(std::string{word}) + " is unknown: it is not judged");
            else if (alarms_.values.size() == before)
                report_.fault(element, "the alarm names " + in_quotes(label) +
                                           ", which the enumeration lacks: it is not judged");
        }
    }

    /// An agreement of ours: AncillaryData "latch" with the content "true" makes the alarm stay until it is reset.
    void read_latch(pugi::xml_node set) {
        for (const pugi::xml_node data : set.children("AncillaryData")) {
            if (name_of(data) != "latch") continue;
            const std::string word = data.text().as_string();
            if (word != "true" && word != "false")
                report_.fault(data, "alarm: latch " + in_quotes(word) + " is neither true nor false");
            alarms_.latches = word == "true";
        }
    }

    const PacketType& type_;
    Reporter& report_;
    Alarms alarms_;
};

}  // namespace

Alarms read_alarm(pugi::xml_node alarm, const PacketType& type, Reporter& report) {
    return AlarmReader{type, report}.read(alarm);
}

void ModelTypes::read_alarms(const Symbol& symbol, PacketType& type) {
    if (const pugi::xml_node alarm = symbol.element.child("DefaultAlarm"))
        type.alarms = read_alarm(alarm, type, parts_.report);
    const pugi::xml_node list = symbol.element.child("ContextAlarmList");
    if (list) type.context_alarms.clear();
    for (const pugi::xml_node alarm : list.children("ContextAlarm")) {
        const pugi::xml_node match = alarm.child("ContextMatch");
        auto when = parts_.condition(symbol.scope, match);
        auto alarms = read_alarm(alarm, type, parts_.report);
        if (when.form == Condition::Form::always)
            parts_.report.fault(match ? match : alarm, "a ContextAlarm without a context is not judged");
        else
            type.context_alarms.push_back({std::move(when), std::move(alarms)});
    }
}

}  // namespace aeolis::dictionary::xtce
