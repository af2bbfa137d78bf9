// SPDX-License-Identifier: Apache-2.0
#include "server/instruction/plan_reader.hpp"

#include "server/instruction/team_reader.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace aeolis::server::instruction {
namespace {

using Kind = YamlNode::Kind;
using procedures::TextFinding;

constexpr double duration_s_max = 7.0 * 86'400.0;  ///< chosen: no fault lasts longer than a week

class PlanReader : public TeamReader {
  public:
    PlanReader(const std::string& file, const dictionary::Dictionary& dictionary, const CheckFault& check)
        : TeamReader(file, dictionary), check_(check) {}

    ReadPlan read(std::string_view text);

  private:
    double duration_s(const YamlNode& node, std::string_view name);
    void device_fault(const YamlNode& node, v1::DeviceFault& fault);
    v1::FaultInjection fault(const YamlNode& node);
    Inject inject(const YamlNode& node);
    void check_contradiction(const Inject& inject, const YamlNode& node);

    const CheckFault& check_;
};

double PlanReader::duration_s(const YamlNode& node, std::string_view name) {
    const YamlNode* given = node.member(name);
    return given == nullptr ? 0.0 : number(*given, name, 0.0, duration_s_max, " s").value_or(0.0);
}

void PlanReader::device_fault(const YamlNode& node, v1::DeviceFault& fault) {
    static constexpr std::array must{std::string_view{"device"}, std::string_view{"unit"}, std::string_view{"kind"},
                                     std::string_view{"duration_s"}};
    static constexpr std::array may{std::string_view{"late_s"}};
    if (!table(node, "a fault of a device", must, may)) return;
    const auto read = [&](std::string_view name, const google::protobuf::EnumDescriptor& all, std::string_view prefix) {
        const YamlNode* given = node.member(name);
        return given == nullptr ? 0 : enumerator(*given, name, all, prefix).value_or(0);
    };
    fault.set_device(static_cast<v1::Device>(read("device", *v1::Device_descriptor(), "DEVICE_")));
    fault.set_unit(static_cast<v1::RedundantUnit>(read("unit", *v1::RedundantUnit_descriptor(), "REDUNDANT_UNIT_")));
    fault.set_kind(
        static_cast<v1::DeviceFaultKind>(read("kind", *v1::DeviceFaultKind_descriptor(), "DEVICE_FAULT_KIND_")));
    fault.set_duration_s(duration_s(node, "duration_s"));
    if (node.member("late_s") != nullptr) fault.set_late_s(duration_s(node, "late_s"));
}

v1::FaultInjection PlanReader::fault(const YamlNode& node) {
    v1::FaultInjection read;
    const auto before = findings_.size();
    if (node.member("device") != nullptr) {
        device_fault(node, *read.mutable_device_fault());
    } else {
        static constexpr std::array kinds{std::string_view{"station_outage_s"}, std::string_view{"system_fault_s"},
                                          std::string_view{"computer_reset"}};
        if (!table(node, "a fault", {}, kinds)) return read;
        if (node.keys.size() != 1)
            add(node.mark, "a fault is one of these: device, station_outage_s, system_fault_s, computer_reset");
        else if (node.member("station_outage_s") != nullptr)
            read.mutable_station_outage()->set_duration_s(duration_s(node, "station_outage_s"));
        else if (node.member("system_fault_s") != nullptr)
            read.mutable_system_fault()->set_duration_s(duration_s(node, "system_fault_s"));
        else if (const YamlNode* reset = node.member("computer_reset"))
            read.set_computer_reset(yes_or_no(*reset, "computer_reset").value_or(true));
    }
    if (findings_.size() == before && check_)
        if (const auto possible = check_(read); !possible) add(node.mark, possible.error().message);
    return read;
}

/// The commands that are wanted and unwanted at once.
void PlanReader::check_contradiction(const Inject& inject, const YamlNode& node) {
    using Act = Expectation::Act;
    for (const auto& wanted : inject.handling.team)
        for (const auto& unwanted : inject.handling.team) {
            if (wanted.act != Act::command || unwanted.act != Act::no_command) continue;
            const bool all_unwanted =
                unwanted.names.empty() || std::ranges::all_of(wanted.names, [&](const auto& name) {
                    return std::ranges::find(unwanted.names, name) != unwanted.names.end();
                });
            if (all_unwanted)
                add(node.mark,
                    fmt::format("inject '{}': its team {}, and {}", inject.id, text_of(wanted), text_of(unwanted)));
        }
}

Inject PlanReader::inject(const YamlNode& node) {
    static constexpr std::array must{std::string_view{"inject"}, std::string_view{"title"}, std::string_view{"when"},
                                     std::string_view{"fault"}};
    static constexpr std::array may{std::string_view{"after_s"}, std::string_view{"shows"}, std::string_view{"signs"},
                                    std::string_view{"team"}};
    Inject read;
    if (!table(node, "an inject", must, may)) return read;
    if (const YamlNode* name = node.member("inject")) read.id = id(*name, "inject");
    read.title = words(node, "title", "the title of an inject");
    read.shows = words(node, "shows", "what shows of an inject");
    if (const YamlNode* when = node.member("when")) {
        if (when->kind != Kind::scalar)
            read.when = conditions(when);
        else if (words(*when, "'when'") != "by hand")
            add(when->mark, "'when' is 'by hand', or a list of conditions");
    }
    if (const YamlNode* after = node.member("after_s")) {
        read.after_s = number(*after, "after_s", 0.0, within_s_max, " s").value_or(0.0);
        if (read.when.empty()) add(after->mark, "what is injected by hand has no 'after_s'");
    }
    if (const YamlNode* given = node.member("fault")) read.fault = fault(*given);
    read.handling = handling(node);
    if (read.handling.team.empty() && node.member("team") != nullptr)
        add(node.member("team")->mark,
            "a team that shall do nothing: leave 'team' out, and the rubric says what it does");
    if (read.handling.team.empty() && !read.handling.signs.empty())
        add(node.member("signs")->mark, "'signs' stands beside a 'team'; without one the rubric says both");
    check_contradiction(read, node);
    return read;
}

ReadPlan PlanReader::read(std::string_view text) {
    static constexpr std::array must{std::string_view{"plan"}, std::string_view{"title"}, std::string_view{"purpose"},
                                     std::string_view{"source"}, std::string_view{"injects"}};
    static constexpr std::array may{std::string_view{"scenario"}};
    auto document = procedures::read_yaml(text, file_);
    findings_ = std::move(document.findings);
    InjectPlan plan;
    if (document.root && table(*document.root, "a plan", must, may)) {
        const YamlNode& root = *document.root;
        plan.id = id_of_file(root, "plan");
        plan.title = words(root, "title", "'title'");
        plan.purpose = words(root, "purpose", "'purpose'");
        plan.source = words(root, "source", "'source'");
        plan.scenario = words(root, "scenario", "'scenario'");
        for (const YamlNode& item : list(root.member("injects"), "'injects'", injects_max))
            plan.injects.push_back(inject(item));
        if (const YamlNode* injects = root.member("injects");
            injects != nullptr && injects->kind == Kind::sequence && injects->items.empty())
            add(injects->mark, "'injects' has no inject");
    }
    if (findings_.empty() && document.root) return {std::move(plan), {}};
    return {std::nullopt, all_findings()};
}

}  // namespace

std::string ReadPlan::findings_text() const {
    std::string text;
    for (const auto& finding : findings) text += (text.empty() ? "" : "\n") + finding.text();
    return text;
}

ReadPlan read_plan(std::string_view text, const std::string& file, const dictionary::Dictionary& dictionary,
                   const CheckFault& check) {
    return PlanReader{file, dictionary, check}.read(text);
}

}  // namespace aeolis::server::instruction
