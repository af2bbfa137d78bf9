// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/state_machine_events.hpp"

#include "generated/state_machines.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>

namespace dictionaries_state_machine_events_test {

using namespace aeolis;

TEST_CASE("the events of a state machine have on ground the numbers that they have on board",
          "[state_machines][R38][R48]") {
    const auto& machines = tests::shipped_dictionary().state_machines;
    const auto events = [&](const char* name) {
        const auto machine = std::ranges::find(machines, name, &dictionary::StateMachineTable::name);
        REQUIRE(machine != machines.end());
        return dictionary::events_of(*machine);
    };
    const auto modes = events("GncMode");
    CHECK(modes.at(static_cast<std::size_t>(flight::GncModeEvent::enabled)) == "enabled");
    CHECK(modes.at(static_cast<std::size_t>(flight::GncModeEvent::drag_felt)) == "drag_felt");
    CHECK(modes.at(static_cast<std::size_t>(flight::GncModeEvent::flyaway_started)) == "flyaway_started");
    CHECK(modes.size() == static_cast<std::size_t>(flight::GncModeEvent::flyaway_started) + 1);
    const auto phases = events("EdlPhase");
    CHECK(phases.at(static_cast<std::size_t>(flight::EdlPhaseEvent::late_cruise_begins)) == "late_cruise_begins");
    CHECK(phases.at(static_cast<std::size_t>(flight::EdlPhaseEvent::engines_off)) == "engines_off");
}

}  // namespace dictionaries_state_machine_events_test
