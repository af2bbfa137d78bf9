// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace aeolis::dictionary {

/// The events of a state machine in the order of their numbers on board, which is that of first use in the sheet.
inline std::vector<std::string> events_of(const StateMachineTable& machine) {
    std::vector<std::string> events;
    for (const StateTransition& row : machine.transitions)
        if (std::ranges::find(events, row.event) == events.end()) events.push_back(row.event);
    return events;
}

}  // namespace aeolis::dictionary
