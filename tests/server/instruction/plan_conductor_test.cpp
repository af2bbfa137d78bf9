// SPDX-License-Identifier: Apache-2.0
#include "server/instruction/plan_conductor.hpp"

#include "server/instruction/plan_reader.hpp"
#include "server/rehearsal/rehearsal.hpp"
#include "server/scenario/scenario_library.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

namespace server_instruction_plan_conductor_test {

using namespace aeolis;
using namespace aeolis::server;
using instruction::PlanConductor;

namespace {

constexpr const char* plan_text = R"(plan: p
title: T
purpose: P
source: S
injects:
  - {inject: at_time, title: A, when: [{from: "E-14:30 vehicle"}], fault: {computer_reset: true}}
  - {inject: later, title: B, when: [{from: "E-14:30 vehicle"}], after_s: 7, fault: {computer_reset: true}}
  - {inject: at_event, title: C, when: [{event: EDL_BEGUN}], fault: {computer_reset: true}}
  - inject: at_value
    title: D
    when: [{channel: parameters_received, is: "==", value: true}, {event: EDL_BEGUN}]
    fault: {computer_reset: true}
  - {inject: by_hand, title: E, when: by hand, fault: {computer_reset: true}}
  - {inject: never, title: F, when: [{event: TOUCHDOWN}], fault: {computer_reset: true}}
)";

instruction::InjectPlan plan() {
    auto read = instruction::read_plan(plan_text, "p.yaml", tests::shipped_dictionary(), {}, {});
    REQUIRE(read.plan);
    return std::move(*read.plan);
}

simulation::Scenario scenario() {
    auto read = ScenarioLibrary{AEOLIS_SOURCE_DIR "/simulation/scenarios"}.scenario("nominal_auto");
    REQUIRE(read);
    read->start_before_entry_s = 900.0;
    read->commands[0].send_before_entry_s = 895.0;
    read->commands[1].send_before_entry_s = 885.0;
    return *read;
}

}  // namespace

TEST_CASE("injects are due once, at their time, event or value on board, and after their delay", "[instruction][R59]") {
    Rehearsal rehearsal{scenario(), 1, 0, tests::shipped_dictionary()};
    const Scet entry = rehearsal.landing().correlation().scet_of(rehearsal.scenario().entry_sclk);
    PlanConductor conductor{plan(), tests::shipped_dictionary(), {entry, rehearsal.landing().light_time_s()}};
    std::map<std::string, double> due;
    while (rehearsal.clocks().e_s() < -850.0) {
        rehearsal.step();
        for (const auto* inject : conductor.pass(rehearsal.landing().report().recorded, rehearsal.landing().ert_now()))
            CHECK(due.emplace(inject->id, rehearsal.clocks().e_s()).second);
    }
    CHECK(due.size() == 4);
    CHECK(due["at_time"] == Approx(-870.0).margin(0.02));
    CHECK(due["later"] == Approx(due["at_time"] + 7.0).margin(0.02));
    CHECK(due["at_event"] == Approx(-885.0).margin(3.0));  // the vehicle has the command
    CHECK(due["at_value"] >= due["at_event"]);
    CHECK(due["at_value"] < due["at_event"] + 30.0);
    CHECK(conductor.waiting("by_hand"));
    CHECK_THAT(conductor.waiting("at_time").error().message, Catch::Contains("waits no more"));
    CHECK_THAT(conductor.waiting("none").error().message, Catch::Contains("'p' has no inject 'none'"));
    conductor.settle("by_hand");
    CHECK(!conductor.waiting("by_hand"));
}

}  // namespace server_instruction_plan_conductor_test
