// SPDX-License-Identifier: Apache-2.0
#include "commands/request_form.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <limits>

namespace commands_request_form_test {

using namespace aeolis;
using namespace aeolis::commands;

namespace {

Request named(std::string command, std::vector<NamedValue> arguments = {}) {
    Request request;
    request.command = std::move(command);
    request.arguments = std::move(arguments);
    return request;
}
Request acting(std::string action, std::uint64_t number) {
    Request request;
    request.action = std::move(action);
    request.number = number;
    return request;
}
std::string fault(const Request& request) {
    const auto checked = check_form(request, tests::shipped_dictionary());
    return checked ? "" : checked.error().message;
}

}  // namespace

TEST_CASE("a request that makes no sense is told apart by what it says alone, and the field is named",
          "[gateway][bounds][R62]") {
    CHECK(fault(named("NO_OP")).empty());
    CHECK(fault(acting("cancel", 7)).empty());
    CHECK(fault(named("EDL_DO_EDL")).empty());  // hazardous and not armed: another time it may be

    auto service = named("NO_OP");
    service.service = "CD";
    CHECK(fault(service) == "unknown service 'CD': AD, BD, or none for what suits");
    auto controller = named("NO_OP");
    controller.controller = std::string(controller_name_max + 1, 'x');
    CHECK(fault(controller) == "controller: a name of at most 64 octets is wanted");
    controller.controller.pop_back();
    CHECK(fault(controller).empty());
    controller.controller = std::string{"Ada\0Eve", 7};  // other programs would read "Ada"
    CHECK(fault(controller) == "controller: a NUL character is no text");
    CHECK_THAT(fault(named("DO_A_BARREL_ROLL")), Catch::StartsWith("unknown command 'DO_A_BARREL_ROLL'"));
    CHECK(fault(acting("launch", 7)) == "unknown action 'launch': release, hold, cancel or approve");
    CHECK(fault(acting("hold", 0)) == "number: that of the waiting command is wanted, from 1");
    auto tried = acting("hold", 7);
    tried.dry_run = true;
    CHECK_THAT(fault(tried), Catch::StartsWith("dry_run: "));
}

TEST_CASE(
    "arguments that cannot be encoded make no sense; with ground's solution only those that are given are looked at",
    "[gateway][bounds][R62]") {
    const char* const offset = "EDL_SET_TIMEPOINT_OFFSET";
    const auto with = [&](double timepoint, double desired_s) {
        return named(offset, {{"timepoint", timepoint}, {"desired_offset_s", desired_s}, {"minimum_offset_s", 0.0}});
    };
    CHECK(fault(with(3.0, -5.0)).empty());
    CHECK_THAT(fault(with(3.5, -5.0)), Catch::Contains("timepoint") && Catch::Contains("whole number"));
    CHECK_THAT(fault(with(-1.0, -5.0)), Catch::Contains("timepoint") && Catch::Contains("-1"));
    for (const double none : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
        CHECK_THAT(fault(with(3.0, none)),
                   Catch::Contains("desired_offset_s") && Catch::Contains("must be a finite number"));
    CHECK_THAT(fault(named("NO_OP", {{"much", 1.0}})), Catch::Contains("NO_OP has no argument 'much'"));

    auto parameters = named("EDL_SET_PARAMETERS");
    CHECK_THAT(fault(parameters), Catch::Contains("is missing"));
    parameters.from_solution = true;
    CHECK(fault(parameters).empty());
    parameters.arguments = {{"parachute_speed_mps", -1.0}};
    CHECK_THAT(fault(parameters), Catch::Contains("parachute_speed_mps") && Catch::Contains("must be"));
    parameters.arguments = {{"parachute_speed", 405.0}};
    CHECK_THAT(fault(parameters), Catch::Contains("has no argument 'parachute_speed'"));
}

}  // namespace commands_request_form_test
