// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/xtce/layouts.hpp"

#include <map>
#include <set>
#include <string>
#include <vector>

namespace aeolis::dictionary::xtce {

/// Packets and events as the dictionary has them.
struct Packets {
    std::vector<Packet> packets;
    std::vector<Event> events;

    /// Every container of an event, also those with findings, and whether its own entries are arguments.
    struct DeclaredEvent {
        std::string name;
        bool has_arguments = false;
    };
    std::vector<DeclaredEvent> declared_events;
    std::map<std::string, EvrId> event_by_path;
};

Packets read_packets(const Symbols& symbols, const Parameters& parameters, const Layouts& layouts, Reporter& report);

}  // namespace aeolis::dictionary::xtce
