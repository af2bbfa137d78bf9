// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/unit_selector.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/device_module.hpp"

namespace flight_unit_selector_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

const CommandTag tag{command::EDL_SELECT_UNITS::opcode, 7};

SelectUnitsCommand select_pyro_and_uhf_b() {
    SelectUnitsCommand command{tag, {}};
    command.arguments.pyro_unit = SelectedUnit::b;
    command.arguments.uhf_unit = SelectedUnit::b;
    return command;
}

}  // namespace

TEST_CASE("the selected units go to every device manager, to the channels and back as the command's outcome",
          "[devices][R2][R5]") {
    test::Spoken<UnitSelector> units{ModuleId::units};
    units.on(select_pyro_and_uhf_b());
    UnitSelection expected;
    expected[Device::pyro] = expected[Device::uhf] = Unit::b;
    CHECK(units.module.selected() == expected);
    std::vector<ModuleId> told;
    for (const auto& envelope : units.recorder.out.sent())
        if (const auto* selected = std::get_if<UnitsSelected>(&envelope.message)) {
            told.push_back(envelope.to);
            CHECK(selected->units == expected);
        }
    CHECK(told == std::vector{ModuleId::radar, ModuleId::imu, ModuleId::edl, ModuleId::pyro, ModuleId::descent_engines,
                              ModuleId::thrusters, ModuleId::power, ModuleId::telecom});
    CHECK(units.recorder.events<evr::UNITS_SELECTED>() == 1);
    CHECK(units.recorder.packets<packet::UnitsHeld>() == 1);
    REQUIRE(units.recorder.sent<CommandOutcome>().size() == 1);
    CHECK_FALSE(units.recorder.sent<CommandOutcome>()[0].refused);
}

TEST_CASE("the channels of the selection name each device's unit", "[devices][R2]") {
    test::Spoken<UnitSelector> units{ModuleId::units};
    units.on(select_pyro_and_uhf_b());
    for (const auto& record : units.recorder.sent<Record>()) {
        if (record.apid != packet::UnitsHeld::apid) continue;
        for (std::size_t device = 0; device < redundant_device_count; ++device)
            CHECK(
                read_bits(record.data, device * 8, 8) ==
                (static_cast<Device>(device) == Device::pyro || static_cast<Device>(device) == Device::uhf ? 1U : 0U));
    }
}

TEST_CASE("once EDL has begun the units stay as they are, and a selection is refused for its phase", "[devices][R2]") {
    test::Spoken<UnitSelector> units{ModuleId::units};
    units.on(EdlBegun{});
    units.on(select_pyro_and_uhf_b());
    CHECK(units.module.selected() == UnitSelection{});
    CHECK(units.recorder.sent<UnitsSelected>().empty());
    REQUIRE(units.recorder.sent<CommandOutcome>().size() == 1);
    CHECK(units.recorder.sent<CommandOutcome>()[0].refused == CommandRefusal::wrong_phase);
    CHECK(units.recorder.sent<CommandOutcome>()[0].tag.count == 7);
}

TEST_CASE("a computer that takes over addresses the units that the other held, EDL begun or not", "[devices][R2]") {
    test::Spoken<UnitSelector> units{ModuleId::units};
    units.on(EdlBegun{});
    CHECK(units.on(test::all_b()).sent<UnitsSelected>().size() == 8);
    CHECK(units.module.selected() == test::all_b().units);
}

TEST_CASE("the selection is reported every ten seconds", "[devices][R2]") {
    test::Spoken<UnitSelector> units{ModuleId::units};
    int reports = 0;
    for (int tick = 0; tick < 64 * 30; ++tick)
        reports += units.on(ClockTick{Sclk::from_ticks(64000 + tick)}, Sclk::from_ticks(64000 + tick))
                       .packets<packet::UnitsHeld>();
    CHECK(reports == 3);
}

TEST_CASE("the backup follows prime's units in silence, and reports them once EDL is its own", "[devices][R2][R33]") {
    Load load;
    load.role = Role::second_chance;
    test::Spoken<UnitSelector> units{ModuleId::units, UnitSelector{load}};
    CHECK(units.on(test::all_b()).packets<packet::UnitsHeld>() == 0);
    CHECK(units.recorder.sent<UnitsSelected>().size() == 8);
    CHECK(units.on(ClockTick{Sclk{1000.0}}, Sclk{1000.0}).packets<packet::UnitsHeld>() == 0);
    units.on(EdlBegun{});
    CHECK(units.on(ClockTick{Sclk{1010.0}}, Sclk{1010.0}).packets<packet::UnitsHeld>() == 1);
}

TEST_CASE("a prime that stands by says nothing of the units: the other computer does", "[devices][R2][R33]") {
    test::Spoken<UnitSelector> units{ModuleId::units};
    units.on(EdlBegun{});
    units.on(StandBy{});
    CHECK(units.on(ClockTick{Sclk{1010.0}}, Sclk{1010.0}).packets<packet::UnitsHeld>() == 0);
    units.on(StandBy{.over = true});
    CHECK(units.on(ClockTick{Sclk{1020.0}}, Sclk{1020.0}).packets<packet::UnitsHeld>() == 1);
}

}  // namespace flight_unit_selector_test
