// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/spreadsheet/state_machines.hpp"

#include "dictionaries/spreadsheet/table.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>

namespace aeolis::dictionary {
namespace {

struct Machine {
    StateMachineTable table;
    const Type* states = nullptr;  ///< null: unknown, not checked
    unsigned first_line = 0;
    std::optional<unsigned> initial_line;
    std::map<std::pair<std::string, std::string>, unsigned> line_of;  ///< of each from and event
};

/// Reads a state's name; a finding when the machine's enumeration has no such label.
std::string read_state(RowReader& cells, std::string_view column, const Machine& machine) {
    const std::string state = cells.identifier(column);
    const bool known =
        machine.states == nullptr || state.empty() ||
        std::ranges::find(machine.states->enumeration, state, &EnumValue::label) != machine.states->enumeration.end();
    if (!known)
        cells.fault(std::string{column} + " " + in_quotes(state) + " is no label of the enumeration " +
                    in_quotes(machine.table.name));
    return state;
}

void read_initial(RowReader& cells, Machine& machine) {
    machine.table.initial = read_state(cells, "to", machine);
    if (machine.initial_line)
        cells.fault("has an initial state already, in line " + std::to_string(*machine.initial_line));
    else
        machine.initial_line = cells.line();
}

void read_transition(RowReader& cells, Machine& machine) {
    StateTransition row;
    row.line = cells.line();
    row.from = read_state(cells, "from", machine);
    row.event = cells.identifier("event");
    row.to = read_state(cells, "to", machine);
    row.note = cells.text("note");
    if (row.from == row.to) cells.fault("from " + in_quotes(row.from) + " leads to itself: leave the row out");
    const auto [first, added] = machine.line_of.emplace(std::pair{row.from, row.event}, row.line);
    if (!added)
        cells.fault("event " + in_quotes(row.event) + " leads from " + in_quotes(row.from) + " already, in line " +
                    std::to_string(first->second));
    machine.table.transitions.push_back(std::move(row));
}

void check_reachable(const Machine& machine, Findings& findings) {
    std::set<std::string> reached{machine.table.initial};
    for (bool grew = true; grew;) {
        grew = false;
        for (const StateTransition& row : machine.table.transitions)
            if (reached.contains(row.from)) grew = reached.insert(row.to).second || grew;
    }
    for (const EnumValue& state : machine.states->enumeration)
        if (!reached.contains(state.label))
            findings.add(machine.first_line, "machine " + in_quotes(machine.table.name) + ": state " +
                                                 in_quotes(state.label) + " cannot be reached from " +
                                                 in_quotes(machine.table.initial));
}

}  // namespace

std::optional<std::vector<StateMachineTable>>
read_state_machines(std::string_view text, const std::vector<const Type*>* enumerations, Findings& findings) {
    const auto table = Table::read(text, {"machine", "from", "event", "to", "note"}, findings);
    if (!table) return std::nullopt;
    if (table->rows().size() > transitions_max) {
        findings.add(table->rows()[transitions_max].line,
                     "more than " + std::to_string(transitions_max) + " transitions");
        return std::nullopt;
    }
    std::vector<Machine> machines;
    bool sound = true;  // false: a row is broken, so its states must not be reported as unreachable too
    for (const Sheet::Row& sheet_row : table->rows()) {
        const std::size_t before = findings.size();
        RowReader cells{*table, sheet_row, "machine", "machine", findings};
        const std::string name = cells.identifier("machine");
        auto machine = std::ranges::find(machines, name, [](const Machine& each) { return each.table.name; });
        if (machine == machines.end()) {
            machine = machines.insert(machines.end(), Machine{});
            machine->table.name = name;
            machine->first_line = sheet_row.line;
            if (enumerations != nullptr) {
                const auto states = std::ranges::find(*enumerations, name, [](const Type* type) { return type->name; });
                if (states != enumerations->end())
                    machine->states = *states;
                else if (!name.empty())
                    cells.fault("there is no enumeration of that name, whose labels could be its states");
            }
        }
        if (cells.text("from").empty() && cells.text("event").empty())
            read_initial(cells, *machine);
        else
            read_transition(cells, *machine);
        sound = sound && findings.size() == before;
    }
    std::vector<StateMachineTable> tables;
    for (Machine& machine : machines) {
        if (!machine.initial_line) {
            findings.add(machine.first_line, "machine " + in_quotes(machine.table.name) +
                                                 " has no initial state: a row without from and event");
        } else if (sound && machine.states != nullptr) {
            check_reachable(machine, findings);
        }
        tables.push_back(std::move(machine.table));
    }
    return tables;
}

}  // namespace aeolis::dictionary
