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

    // What ground's solution takes from the scenario has to be what the command takes.
    scenario.parachute_speed_mps = 330.0;
    const auto solution = check_script(scenario, tests::shipped_dictionary());
    REQUIRE_FALSE(solution);
    CHECK(solution.error().message ==
          "commands[0]: argument 'parachute_speed_mps' of EDL_SET_PARAMETERS is 330 m/s: must be from 380 to 450 m/s");
    scenario.commands[0].arguments = {{"parachute_speed_mps", 405.0}};
    CHECK(check_script(scenario, tests::shipped_dictionary()));
    scenario.parachute_speed_mps = 405.0;

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
