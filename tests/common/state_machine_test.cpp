// SPDX-License-Identifier: Apache-2.0
#include "common/state_machine.hpp"
#include "tests/support/catch.hpp"

#include <array>

namespace common_state_machine_test {

using namespace aeolis;

namespace {

enum class Door { shut, open, locked };
enum class DoorEvent { pushed, pulled, key };
using DoorMachine = StateMachine<Door, DoorEvent>;

constexpr std::array<Transition<Door, DoorEvent>, 4> table{{
    {Door::shut, DoorEvent::pushed, Door::open},
    {Door::open, DoorEvent::pulled, Door::shut},
    {Door::shut, DoorEvent::key, Door::locked},
    {Door::locked, DoorEvent::key, Door::shut},
}};

}  // namespace

TEST_CASE("a state machine changes its state as its table says", "[state_machine][R48]") {
    DoorMachine door{table, Door::shut};
    CHECK(door.can(DoorEvent::pushed));
    CHECK(door.take(DoorEvent::pushed));
    CHECK(door.state() == Door::open);
    CHECK(door.take(DoorEvent::pulled));
    CHECK(door.take(DoorEvent::key));
    CHECK(door.state() == Door::locked);
}

TEST_CASE("an event without a row from the present state changes nothing", "[state_machine][R48]") {
    DoorMachine door{table, Door::locked};
    CHECK_FALSE(door.can(DoorEvent::pushed));
    CHECK_FALSE(door.take(DoorEvent::pushed));
    CHECK_FALSE(door.take(DoorEvent::pulled));
    CHECK(door.state() == Door::locked);
}

TEST_CASE("a state machine is carried as its state", "[state_machine][R33]") {
    DoorMachine door{table, Door::shut};
    Door carried = Door::open;
    const auto restore = [&](Door& state) { state = carried; };
    door.carry(restore);
    CHECK(door.state() == Door::open);
    CHECK(door.take(DoorEvent::pulled));
}

}  // namespace common_state_machine_test
