// SPDX-License-Identifier: Apache-2.0
#include "server/instruction/plan_reader.hpp"
#include "server/instruction/team_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace aeolis::server::instruction {
namespace {

constexpr double all_points = 100.0;
constexpr std::size_t calls_max = 50, fault_kinds_max = 50;  ///< chosen

class RubricReader : public TeamReader {
  public:
    RubricReader(const std::string& file, const dictionary::Dictionary& dictionary) : TeamReader(file, dictionary) {}

    ReadRubric read(std::string_view text);

  private:
    double number_of(const YamlNode& node, std::string_view name, double least, double most, std::string_view unit);
    void worth(const YamlNode& node, Rubric& rubric);
    Call call(const YamlNode& node);
    FaultHandling fault(const YamlNode& node);
};

double RubricReader::number_of(const YamlNode& node, std::string_view name, double least, double most,
                               std::string_view unit) {
    const YamlNode* given = node.member(name);
    return given == nullptr ? 0.0 : number(*given, name, least, most, unit).value_or(0.0);
}

void RubricReader::worth(const YamlNode& node, Rubric& rubric) {
    std::vector<std::string_view> must{"landing"};
    for (const Skill skill : skills) must.push_back(name_of(skill));
    if (!table(node, "'worth'", must, {})) return;
    rubric.landing_worth = number_of(node, "landing", 0.0, all_points, "");
    for (const Skill skill : skills)
        rubric.worth[static_cast<std::size_t>(skill)] = number_of(node, name_of(skill), 0.0, all_points, "");
    const double sum = std::accumulate(rubric.worth.begin(), rubric.worth.end(), rubric.landing_worth);
    if (std::abs(sum - all_points) > 1.0e-6) add(node.mark, fmt::format("all together are worth 100, not {}", sum));
}

Call RubricReader::call(const YamlNode& node) {
    static constexpr std::array must{std::string_view{"after"}, std::string_view{"note"}, std::string_view{"within_s"}};
    Call read;
    if (!table(node, "a call", must, {})) return read;
    read.after = words(node, "after", "an event or a tone");
    if (!read.after.empty() && !is_report(read.after))
        add(node.member("after")->mark, fmt::format("'{}' is neither an event nor a tone", read.after));
    if (const YamlNode* note = node.member("note")) read.words = names(*note, "'note'");
    read.within_s = within_s(node);
    return read;
}

FaultHandling RubricReader::fault(const YamlNode& node) {
    static constexpr std::array must{std::string_view{"fault"}, std::string_view{"team"}};
    static constexpr std::array may{std::string_view{"signs"}, std::string_view{"device"}, std::string_view{"kind"}};
    static constexpr std::array kinds{
        std::pair{std::string_view{"device_fault"}, v1::FaultInjection::kDeviceFault},
        std::pair{std::string_view{"station_outage"}, v1::FaultInjection::kStationOutage},
        std::pair{std::string_view{"orbiter_outage"}, v1::FaultInjection::kOrbiterOutage},
        std::pair{std::string_view{"uhf_loss"}, v1::FaultInjection::kUhfLoss},
        std::pair{std::string_view{"wind_shift"}, v1::FaultInjection::kWindShift},
        std::pair{std::string_view{"air_shift"}, v1::FaultInjection::kAirShift},
        std::pair{std::string_view{"false_tone"}, v1::FaultInjection::kFalseTone},
        std::pair{std::string_view{"sensor_error"}, v1::FaultInjection::kSensorError},
        std::pair{std::string_view{"system_fault"}, v1::FaultInjection::kSystemFault},
        std::pair{std::string_view{"computer_reset"}, v1::FaultInjection::kComputerReset},
    };
    FaultHandling read;
    if (!table(node, "a kind of fault", must, may)) return read;
    if (const YamlNode* given = node.member("fault")) {
        const std::string text = words(*given, "a kind of fault");
        const auto* const kind = std::ranges::find(kinds, text, [](const auto& each) { return each.first; });
        if (kind != kinds.end())
            read.kind = kind->second;
        else if (!text.empty())
            add(given->mark, procedures::unknown_name(text, "kind of fault", kinds,
                                                      [](const auto& each) -> std::string_view { return each.first; }));
    }
    if (const YamlNode* device = node.member("device"))
        if (const auto value = enumerator(*device, "device", *v1::Device_descriptor(), "DEVICE_"))
            read.device = static_cast<v1::Device>(*value);
    if (const YamlNode* kind = node.member("kind"))
        if (const auto value = enumerator(*kind, "kind", *v1::DeviceFaultKind_descriptor(), "DEVICE_FAULT_KIND_"))
            read.device_kind = static_cast<v1::DeviceFaultKind>(*value);
    read.handling = handling(node);
    return read;
}

ReadRubric RubricReader::read(std::string_view text) {
    static constexpr std::array must{std::string_view{"rubric"}, std::string_view{"title"},
                                     std::string_view{"source"}, std::string_view{"worth"},
                                     std::string_view{"alarms"}, std::string_view{"present_s"},
                                     std::string_view{"calls"},  std::string_view{"faults"}};
    auto document = procedures::read_yaml(text, file_);
    findings_ = std::move(document.findings);
    Rubric rubric;
    if (document.root && table(*document.root, "a rubric", must, {})) {
        const YamlNode& root = *document.root;
        rubric.id = id_of_file(root, "rubric");
        rubric.title = words(root, "title", "'title'");
        static_cast<void>(words(root, "source", "'source'"));
        if (const YamlNode* given = root.member("worth")) worth(*given, rubric);
        static constexpr std::array alarms{std::string_view{"within_s"}, std::string_view{"until_s"}};
        if (const YamlNode* given = root.member("alarms"); given != nullptr && table(*given, "'alarms'", alarms, {})) {
            rubric.alarm_within_s = within_s(*given);
            rubric.alarm_until_s = number_of(*given, "until_s", 1.0, within_s_max, " s");
            if (findings_.empty() && rubric.alarm_until_s <= rubric.alarm_within_s)
                add(given->mark, "'until_s' must be more than 'within_s'");
        }
        rubric.present_s = number_of(root, "present_s", 1.0, within_s_max, " s");
        for (const YamlNode& item : list(root.member("calls"), "'calls'", calls_max))
            rubric.calls.push_back(call(item));
        for (const YamlNode& item : list(root.member("faults"), "'faults'", fault_kinds_max))
            rubric.faults.push_back(fault(item));
    }
    if (findings_.empty() && document.root) return {std::move(rubric), {}};
    return {std::nullopt, all_findings()};
}

}  // namespace

ReadRubric read_rubric(std::string_view text, const std::string& file, const dictionary::Dictionary& dictionary) {
    return RubricReader{file, dictionary}.read(text);
}

}  // namespace aeolis::server::instruction
