// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/findings.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace aeolis::dictionary::xtce {

/// Content of a mission's XTCE file. pugixml stays behind this header.
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
    std::vector<DeclaredEvent> declared_events;  ///< including those with findings
    std::shared_ptr<const PacketModel> model;
};

/// Reads the subset of [xtce-1.2] that docs/decisions/0002 names.
/// None, with a finding, when the text is not XTCE.
std::optional<SpaceSystem> read_space_system(const std::string& text, Findings& findings);

}  // namespace aeolis::dictionary::xtce
