// SPDX-License-Identifier: Apache-2.0
#include "flight/kernel/loads.hpp"

#include "flight/computer_state.hpp"
#include "flight/kernel/dispatch.hpp"
#include "flight/kernel/executive.hpp"
#include "tests/support/catch.hpp"

#include <memory>
#include <vector>

namespace flight_loads_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

std::vector<ModuleId> modules_of(Role role) {
    std::vector<ModuleId> modules;
    for (std::size_t id = 0; id < module_count; ++id)
        if (is_loaded(role, static_cast<ModuleId>(id))) modules.push_back(static_cast<ModuleId>(id));
    return modules;
}

}  // namespace

TEST_CASE("each load has the modules that it lists, and Second Chance goes without what only pre-EDL needs",
          "[loads][R33]") {
    using enum ModuleId;
    CHECK(modules_of(Role::prime) == std::vector{sync, radar, imu, edl, pyro, descent_engines, thrusters, power,
                                                 telecom, units, cruise_attitude, system_fault_protection, cross_string,
                                                 command_dispatcher, edl_bg, mfsk, edl_comm});
    CHECK(modules_of(Role::second_chance) == std::vector{sync, radar, imu, edl, pyro, descent_engines, thrusters, power,
                                                         telecom, units, cross_string, command_dispatcher, edl_bg, mfsk,
                                                         edl_comm});
}

TEST_CASE("what is sent to a module that a load lacks goes nowhere", "[loads][R33]") {
    Load load;
    load.role = Role::second_chance;
    const auto state = std::make_unique<ComputerState>(load, Sclk{1000.0});
    const auto out = std::make_unique<DeviceOutputs>();
    DeviceInputs in;
    in.now = Sclk{1000.0};
    in.system_fault = SystemFaultReport{true};
    Executive{*state}.cycle(in, *out);
    CHECK(state->mailboxes[static_cast<std::size_t>(ModuleId::system_fault_protection)].empty());
    CHECK(state->unexpected_messages == 0);
    CHECK(state->mailbox_overflows == 0);
}

TEST_CASE("every module is made from the load alone, spoken to by messages, and copied as a value", "[loads][R9]") {
    const Load load;
    ComputerState state{load, Sclk{1000.0}};
    std::size_t modules = 0;
    for (std::size_t id = 0; id < module_count; ++id)
        with_module(state, static_cast<ModuleId>(id), [&](auto& module) {
            using Module = std::remove_cvref_t<decltype(module)>;
            STATIC_REQUIRE(FlightModule<Module>);
            const Module another{load};
            const Module copy{another};
            static_cast<void>(copy);
            ++modules;
        });
    CHECK(modules == module_count);
}

}  // namespace flight_loads_test
