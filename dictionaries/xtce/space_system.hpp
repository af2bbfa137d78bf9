// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/findings.hpp"

#include <optional>
#include <string>
#include <vector>

namespace aeolis::dictionary::xtce {

/// What a mission's XTCE file says. pugixml stays behind this header.
struct SpaceSystem {
    struct DeclaredEvent {
        std::string name;
        bool has_arguments = false;
    };

    std::string mission;
    std::vector<Channel> channels;
    std::vector<Packet> packets;
    std::vector<Event> events;
    std::vector<Command> commands;
    std::vector<DeclaredEvent> declared_events;  ///< also those with findings
};

/// None, with a finding, when the text is no XTCE at all. [xtce-1.2], the part of it that docs/decisions/0002 names.
std::optional<SpaceSystem> read_space_system(const std::string& text, Findings& findings);

}  // namespace aeolis::dictionary::xtce
