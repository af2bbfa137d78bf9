// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/autocoder/state_machines_header.hpp"

#include "dictionaries/autocoder/cpp_text.hpp"
#include "dictionaries/state_machine_events.hpp"

#include <sstream>

namespace aeolis::dictionary::autocoder {
namespace {

void write_machine(const StateMachineTable& machine, std::ostringstream& out) {
    const std::string state = camel_case(machine.name);
    const std::string event = state + "Event";
    out << "enum class " << event << " : std::uint8_t {\n";
    for (const std::string& name : events_of(machine)) out << "    " << name << ",\n";
    out << "};\n\nclass " << state << "Machine : public StateMachine<" << state << ", " << event << "> {\n"
        << "  public:\n    constexpr " << state << "Machine() : StateMachine(table, " << state
        << "::" << machine.initial << ") {}\n\n    static constexpr std::array<Transition<" << state << ", " << event
        << ">, " << machine.transitions.size() << "> table{{\n";
    for (const StateTransition& row : machine.transitions)
        out << "#line " << row.line << " \"state_machines.csv\"\n        {" << state << "::" << row.from << ", "
            << event << "::" << row.event << ", " << state << "::" << row.to << "},\n";
    out << "    }};\n};\n\n";
}

}  // namespace

std::string state_machines_header(const Dictionary& dictionary) {
    std::ostringstream out;
    out << made_by_autocoder(dictionary, "state_machines.csv")
        << "#pragma once\n\n#include \"common/state_machine.hpp\"\n#include \"generated/dictionary_flight.hpp\"\n\n"
           "#include <array>\n#include <cstdint>\n\nnamespace aeolis::flight {\n\n";
    for (const StateMachineTable& machine : dictionary.state_machines) write_machine(machine, out);
    out << "}  // namespace aeolis::flight\n";
    return out.str();
}

}  // namespace aeolis::dictionary::autocoder
