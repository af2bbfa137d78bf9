// SPDX-License-Identifier: Apache-2.0
#include "server/scenario/script_check.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

namespace server_script_check_test {

using namespace aeolis;
using namespace aeolis::server;

TEST_CASE("a scenario's own commands are checked before the start, by name and argument", "[scenario][R44]") {
    simulation::Scenario scenario;
    scenario.commands.push_back({1190.0, "EDL_SET_PARAMETERS", {}, true});
    scenario.commands.push_back({1180.0, "EDL_DO_EDL", {}, false});
    CHECK(check_script(scenario, tests::shipped_dictionary()));

    scenario.commands[1].command = "EDL_FROB";
    const auto unknown = check_script(scenario, tests::shipped_dictionary());
    REQUIRE_FALSE(unknown);
    CHECK(unknown.error().message == "commands[1].command: 'EDL_FROB' is no command of the dictionary");

    scenario.commands[1] = {1180.0, "EDL_DO_EDL", {{"zz", 1.0}}, false};
    const auto argument = check_script(scenario, tests::shipped_dictionary());
    REQUIRE_FALSE(argument);
    CHECK(argument.error().message == "commands[1].arguments: EDL_DO_EDL has no argument 'zz'");

    scenario.commands[1] = {1180.0, "EDL_SET_PARAMETERS", {{"parachute_speed_mps", 405.0}}, false};
    const auto value = check_script(scenario, tests::shipped_dictionary());
    REQUIRE_FALSE(value);
    CHECK_THAT(value.error().message,
               Catch::StartsWith("commands[1]: argument ") && Catch::Contains("of EDL_SET_PARAMETERS is missing"));
}

}  // namespace server_script_check_test
