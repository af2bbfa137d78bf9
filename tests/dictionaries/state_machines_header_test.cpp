// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/autocoder/state_machines_header.hpp"
#include "dictionaries/enumerations.hpp"
#include "dictionaries/state_machine_events.hpp"
#include "generated/state_machines.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>

namespace dictionaries_state_machines_header_test {

using namespace aeolis;

TEST_CASE("each transition's code names its row of the spreadsheet, and its states as labels of the dictionary",
          "[dictionary][autocoder][R40][R48]") {
    const auto& dictionary = tests::shipped_dictionary();
    const std::string header = dictionary::autocoder::state_machines_header(dictionary);
    for (const auto& machine : dictionary.state_machines)
        for (const auto& row : machine.transitions)
            CHECK_THAT(header,
                       Catch::Contains("#line " + std::to_string(row.line) + " \"state_machines.csv\"\n        {" +
                                       machine.name + "::" + row.from + ", " + machine.name + "Event::" + row.event +
                                       ", " + machine.name + "::" + row.to + "},\n"));
}

namespace {

/// Whether flight's table has the rows that ground reads, in their order and by the same numbers.
bool same_rows(const dictionary::StateMachineTable& ground, const auto& flight) {
    const auto& dictionary = tests::shipped_dictionary();
    const auto all = dictionary::enumerations_of(dictionary.packets, dictionary.commands);
    const auto states = std::ranges::find(all, ground.name, &dictionary::Type::name);
    REQUIRE(states != all.end());
    const auto events = dictionary::events_of(ground);
    const auto is = [&](auto number, const std::string& state) {
        const auto& labels = (*states)->enumeration;
        const auto entry = std::ranges::find(labels, state, &dictionary::EnumValue::label);
        return entry != labels.end() && static_cast<std::int64_t>(number) == entry->value;
    };
    return std::ranges::equal(flight, ground.transitions, [&](const auto& row, const auto& read) {
        return is(row.from, read.from) && events.at(static_cast<std::size_t>(row.event)) == read.event &&
               is(row.to, read.to);
    });
}

}  // namespace

TEST_CASE("flight's machines have the tables that ground reads", "[dictionary][R48]") {
    const auto& machines = tests::shipped_dictionary().state_machines;
    CHECK(same_rows(machines[0], flight::GncModeMachine::table));
    CHECK(same_rows(machines[1], flight::EdlPhaseMachine::table));
    CHECK_FALSE(same_rows(machines[0], flight::EdlPhaseMachine::table));
    CHECK(flight::GncModeMachine{}.state() == flight::GncMode::off);
    CHECK(flight::EdlPhaseMachine{}.state() == flight::EdlPhase::pre_edl);
}

}  // namespace dictionaries_state_machines_header_test
