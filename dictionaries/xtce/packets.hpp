// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/xtce/layouts.hpp"

#include <map>
#include <set>
#include <string>
#include <vector>

namespace aeolis::dictionary::xtce {

/// Packets and events in the form that the dictionary holds.
struct Packets {
    std::vector<Packet> packets;
    std::vector<Event> events;

    /// An event's container, even one with findings, and whether it has entries of its own as arguments.
    struct DeclaredEvent {
        std::string name;
        bool has_arguments = false;
    };
    std::vector<DeclaredEvent> declared_events;
    std::map<std::string, EvrId> event_by_path;
};

Packets read_packets(const Symbols& symbols, const Parameters& parameters, const Layouts& layouts, Reporter& report);

}  // namespace aeolis::dictionary::xtce
