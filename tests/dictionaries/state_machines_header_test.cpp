// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/autocoder/state_machines_header.hpp"
#include "generated/state_machines.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

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

TEST_CASE("flight's machines have the tables that ground reads", "[dictionary][R48]") {
    const auto& machines = tests::shipped_dictionary().state_machines;
    CHECK(flight::GncModeMachine::table.size() == machines[0].transitions.size());
    CHECK(flight::EdlPhaseMachine::table.size() == machines[1].transitions.size());
    CHECK(flight::GncModeMachine{}.state() == flight::GncMode::off);
    CHECK(flight::EdlPhaseMachine{}.state() == flight::EdlPhase::pre_edl);
}

}  // namespace dictionaries_state_machines_header_test
