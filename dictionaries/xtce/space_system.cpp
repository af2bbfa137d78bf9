// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/space_system.hpp"

#include "dictionaries/xtce/alarms.hpp"
#include "dictionaries/xtce/commands.hpp"

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

}  // namespace

std::optional<SpaceSystem> read_space_system(const std::string& text, Findings& findings) {
    const auto document = Document::parse(text, findings);
    if (!document) return std::nullopt;
    Reporter report{*document, findings};
    const Symbols symbols{{document.get()}, report};
    const Types types{symbols, report};
    Parameters parameters = read_parameters(symbols, types, report);
    read_context_alarms(symbols, parameters, report);
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
    return system;
}

}  // namespace aeolis::dictionary::xtce
