// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/telecom.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/device_module.hpp"

namespace flight_telecom_test {

using namespace aeolis;
using namespace aeolis::flight;

TEST_CASE("telecom settings go to the bus and their replies to Edl", "[devices][R28]") {
    test::Spoken<TelecomManager> telecom{ModuleId::telecom};
    telecom.on(SetSwitch{SwitchId::uhf, true});
    telecom.on(SetSwitch{SwitchId::parachute_antenna, true});
    REQUIRE(telecom.recorder.bus->telecom.size() == 2);
    CHECK(telecom.on(SwitchReply{SwitchId::uhf, true}).sent<ActionReply>().size() == 1);
    CHECK(telecom.on(SwitchReply{SwitchId::parachute_antenna, true}).sent<ActionReply>().size() == 1);
}

TEST_CASE("UHF and X-band are addressed each by its own selected unit", "[devices][R2]") {
    test::Spoken<TelecomManager> telecom{ModuleId::telecom};
    UnitsSelected selected;
    selected.units[Device::x_band] = Unit::b;
    telecom.on(selected);
    CHECK(telecom.recorder.bus->units[Device::uhf] == Unit::a);
    CHECK(telecom.recorder.bus->units[Device::x_band] == Unit::b);
    telecom.on(SetSwitch{SwitchId::uhf, true});
    telecom.on(SetSwitch{SwitchId::entry_antenna, true});
    telecom.on(SetSwitch{SwitchId::x_band_tones, true});
    CHECK(telecom.on(SwitchReply{SwitchId::x_band_tones, true, Unit::b}).sent<ActionReply>().size() == 1);
    CHECK(telecom.on(SwitchReply{SwitchId::entry_antenna, true, Unit::a}).events<evr::REPLY_UNEXPECTED>() == 1);
    CHECK(telecom.on(SwitchReply{SwitchId::entry_antenna, true, Unit::b}).sent<ActionReply>().size() == 1);
    CHECK(telecom.on(SwitchReply{SwitchId::uhf, true, Unit::a}).sent<ActionReply>().size() == 1);
}

}  // namespace flight_telecom_test
