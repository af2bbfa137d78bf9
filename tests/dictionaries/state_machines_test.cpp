// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/spreadsheet/state_machines.hpp"
#include "tests/support/planted.hpp"
#include "tests/support/shipped_dictionary.hpp"

namespace dictionaries_state_machines_test {

using namespace aeolis;
using aeolis::tests::Planted;

TEST_CASE("each broken rule of the state machines gives one line, and nothing is loaded", "[dictionary][R48]") {
    static const std::vector<Planted> all{
        {"unknown state", "state_machines.csv", "GncMode,off,enabled,approach", "GncMode,off,enabled,aproach",
         "to 'aproach' is no label of the enumeration 'GncMode'"},
        {"unknown source", "state_machines.csv", "GncMode,off,enabled", "GncMode,of,enabled",
         "from 'of' is no label of the enumeration 'GncMode'"},
        {"two initial states", "state_machines.csv", "EdlPhase,pre_edl,late_cruise_begins,late_cruise",
         "EdlPhase,,,landed", "has an initial state already"},
        {"not deterministic", "state_machines.csv", "GncMode,touchdown,flyaway_started,flyaway",
         "GncMode,sky_crane,flyaway_started,touchdown",
         "event 'flyaway_started' leads from 'sky_crane' already, in line 25"},
        {"leads to itself", "state_machines.csv", "GncMode,off,enabled,approach", "GncMode,off,enabled,off",
         "leads to itself"},
        {"event no name", "state_machines.csv", "GncMode,off,enabled,", "GncMode,off,ena bled,",
         "event has characters other"},
    };
    for (const Planted& planted : all) tests::check_planted(planted);
}

TEST_CASE("a state that cannot be reached, a machine without a start or without an enumeration, is found",
          "[dictionary][R48]") {
    dictionary::Type door;
    door.name = "Door";
    door.enumeration = {{0, "shut"}, {1, "open"}};
    const std::vector<const dictionary::Type*> enumerations{&door};
    const auto finding = [&](const std::string& rows) {
        std::vector<dictionary::Finding> all;
        dictionary::Findings findings{"state_machines.csv", all};
        (void)dictionary::read_state_machines("machine,from,event,to,note\n" + rows, &enumerations, findings);
        return all.size() == 1 ? all.front().text() : std::to_string(all.size()) + " findings";
    };
    CHECK(finding("Door,,,shut,\nDoor,shut,pushed,open,\n") == "0 findings");
    CHECK(finding("Door,,,shut,\n") ==
          "state_machines.csv:2: machine 'Door': state 'open' cannot be reached from 'shut'");
    CHECK(finding("Door,shut,pushed,open,\n") ==
          "state_machines.csv:2: machine 'Door' has no initial state: a row without from and event");
    CHECK(finding("Window,,,shut,\n") ==
          "state_machines.csv:2: machine 'Window': there is no enumeration of that name, "
          "whose labels could be its states");
}

TEST_CASE("the phase of EDL and the mode of GNC are machines of the shipped dictionary", "[dictionary][R48]") {
    const auto& machines = tests::shipped_dictionary().state_machines;
    REQUIRE(machines.size() == 2);
    CHECK(machines[0].name == "GncMode");
    CHECK(machines[0].initial == "off");
    CHECK(machines[1].name == "EdlPhase");
    CHECK(machines[1].initial == "pre_edl");
}

}  // namespace dictionaries_state_machines_test
