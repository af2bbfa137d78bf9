// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/autocoder/state_diagram.hpp"

#include <sstream>

namespace aeolis::dictionary::autocoder {

std::string state_diagrams(const Dictionary& dictionary) {
    std::ostringstream out;
    for (const StateMachineTable& machine : dictionary.state_machines) {
        out << "## " << machine.name << "\n\n```mermaid\nstateDiagram-v2\n    [*] --> " << machine.initial << "\n";
        for (const StateTransition& row : machine.transitions)
            out << "    " << row.from << " --> " << row.to << ": " << row.event << "\n";
        out << "```\n\n";
    }
    return out.str();
}

}  // namespace aeolis::dictionary::autocoder
