// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/power.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/device_module.hpp"

namespace flight_power_test {

using namespace aeolis;
using namespace aeolis::flight;

TEST_CASE("power switches go to the bus and their replies to Edl", "[devices][R28]") {
    test::Spoken<PowerManager> power{ModuleId::power};
    power.on(SetSwitch{SwitchId::radar, true});
    REQUIRE(power.recorder.bus->switches.size() == 1);
    CHECK(power.recorder.bus->switches[0].id == SwitchId::radar);
    CHECK(power.recorder.bus->switches[0].on);
    const auto replies = power.on(SwitchReply{SwitchId::radar, true}).sent<ActionReply>();
    REQUIRE(replies.size() == 1);
    CHECK(replies[0] == ActionReply{ReplyKind::device_switch, static_cast<std::uint8_t>(SwitchId::radar)});
}

TEST_CASE("power addresses the selected unit, and an answer of the other is reported", "[devices][R2]") {
    test::Spoken<PowerManager> power{ModuleId::power};
    power.on(test::all_b());
    power.on(SetSwitch{SwitchId::radar, true});
    CHECK(power.recorder.bus->units[Device::power] == Unit::b);
    CHECK(power.on(SwitchReply{SwitchId::radar, true, Unit::a}).events<evr::REPLY_UNEXPECTED>() == 1);
    CHECK(power.on(SwitchReply{SwitchId::radar, true, Unit::b}).sent<ActionReply>().size() == 1);
}

}  // namespace flight_power_test
