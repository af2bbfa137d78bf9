// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/space_system.hpp"

#include "dictionaries/xtce/alarms.hpp"
#include "dictionaries/xtce/commands.hpp"
#include "dictionaries/xtce/packet_model_reader.hpp"

#include <memory>
#include <set>
#include <vector>

namespace aeolis::dictionary::xtce {
namespace {

/// Reports channels that no packet carries: they could never have a value.
void check_channels_carried(const Parameters& parameters, const Symbols& symbols, const Layouts& layouts,
                            Reporter& report) {
    std::set<const Parameter*> carried;
    bool all_sound = true;
    for (const Symbol& symbol : symbols.all()) {
        if (symbol.kind != Kind::container) continue;
        all_sound = all_sound && layouts.of(symbol).sound;
        for (const Placed& placed : layouts.of(symbol).entries) carried.insert(placed.parameter);
    }
    if (!all_sound) return;
    for (const auto& [path, parameter] : parameters.by_path)
        if (parameter.channel && !carried.contains(&parameter))
            report.fault(parameter.element, "channel " + in_quotes(parameter.name) + " is in no packet");
}

/// The container with which all packets begin; none, with a finding, when they begin with several.
std::optional<std::size_t> root_of_packets(const PacketModel& model, Reporter& report) {
    std::optional<std::size_t> root;
    for (std::size_t i = 0; i < model.containers.size(); ++i) {
        if (model.containers[i].abstract) continue;
        std::size_t first = i;
        for (unsigned depth = 0; model.containers[first].base && depth < base_depth_max; ++depth)
            first = *model.containers[first].base;
        if (!root) root = first;
        if (*root == first) continue;
        report.fault(model.containers[i].line, "packet " + in_quotes(model.containers[i].name) + " begins with " +
                                                   in_quotes(model.containers[first].name) + ", those before it with " +
                                                   in_quotes(model.containers[*root].name));
        return std::nullopt;
    }
    return root;
}

/// What breaks a rule, and what the model does not understand; of a line what was found first.
void tell(const std::vector<Finding>& of_rules, const std::vector<Finding>& of_model, Findings& findings) {
    std::set<unsigned> lines;
    for (const Finding& finding : of_rules) {
        findings.add(finding.line, finding.message);
        lines.insert(finding.line);
    }
    for (const Finding& finding : of_model)
        if (lines.insert(finding.line).second) findings.add(finding.line, finding.message);
}

}  // namespace

std::optional<SpaceSystem> read_space_system(const std::string& text, Findings& findings) {
    const auto document = Document::parse(text, findings);
    if (!document) return std::nullopt;
    std::vector<Finding> of_rules, of_model;
    Findings rules{{}, of_rules}, understood{{}, of_model};
    Reporter report{*document, rules}, model_report{*document, understood};
    const Symbols symbols{{document.get()}, report};
    const ModelParts parts{symbols, model_report, {}};
    ModelTypes model_types{parts};
    const Types types{symbols, model_types, report};
    Parameters parameters = read_parameters(symbols, types, report);
    read_context_alarms(symbols, model_types, parameters, report);
    const Layouts layouts{symbols, parameters, report};
    Packets packets = read_packets(symbols, parameters, layouts, report);
    check_channels_carried(parameters, symbols, layouts, report);

    SpaceSystem system;
    system.mission = name_of(document->space_system());
    system.commands = read_commands(symbols, types, parameters, packets, report);
    system.channels = parameters.channels;
    system.packets = std::move(packets.packets);
    system.events = std::move(packets.events);
    for (const auto& event : packets.declared_events)
        system.declared_events.push_back({event.name, event.has_arguments});
    PacketModel model = read_model(system.mission, parts, model_types);
    if (of_rules.empty() && of_model.empty()) model.root = root_of_packets(model, report);
    system.model = std::make_shared<const PacketModel>(std::move(model));
    tell(of_rules, of_model, findings);
    return system;
}

}  // namespace aeolis::dictionary::xtce
