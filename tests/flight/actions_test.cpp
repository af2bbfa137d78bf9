// SPDX-License-Identifier: Apache-2.0
#include "flight/timeline/actions.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"

namespace flight_actions_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {
struct Fixture {
    test::OutboxRecorder recorder;
    gnc::Configuration configuration;
    ActionContext context{recorder.out, configuration};
};
}  // namespace

TEST_CASE("the mortar's action fires the mortar; GNC has a parachute only once that is done, since it was commanded",
          "[timeline][R17][R26][R50]") {
    Fixture f;
    action_named<"fire_parachute_mortar">().run(f.context);
    REQUIRE(f.recorder.sent<FirePyro>().size() == 1);
    CHECK(f.recorder.sent<FirePyro>()[0].pyro == PyroId::parachute_mortar);
    CHECK_FALSE(f.configuration.parachute_out);
    f.configuration.learn(f.context.fact(), f.context.now());
    CHECK(f.configuration.parachute_out);
    CHECK(f.configuration.parachute_time == f.context.now());
    f.configuration.learn(f.context.fact(), f.context.now() + 5.0);
    CHECK(f.configuration.parachute_time == f.context.now());  // repeated, it happened when it happened first
    f.configuration.forget(f.context.fact());
    CHECK_FALSE(f.configuration.parachute_out);
    CHECK_FALSE(f.configuration.parachute_time);
}

TEST_CASE("leaving the cruise stage is a process of several actions, and GNC learns when it is gone",
          "[timeline][R26][release]") {
    Fixture f;
    action_named<"vent_coolant">().run(f.context);
    action_named<"cut_cruise_cables">().run(f.context);
    CHECK(f.context.fact() == gnc::Fact::none);
    action_named<"fire_cruise_stage_separation">().run(f.context);
    CHECK(f.context.fact() == gnc::Fact::cruise_stage_gone);
    CHECK(f.recorder.sent<FirePyro>().size() == 3);

    // Each has a timepoint of its own, in this order.
    const auto action_of = [](TimepointId id) { return timeline_specs[id.value].action; };
    CHECK(action_of(timepoint::coolant_vent) == action_named<"vent_coolant">().run);
    CHECK(action_of(timepoint::cruise_cables_cut) == action_named<"cut_cruise_cables">().run);
    CHECK(action_of(timepoint::cruise_stage_separation) == action_named<"fire_cruise_stage_separation">().run);
    CHECK(timepoint::coolant_vent.value < timepoint::cruise_cables_cut.value);
    CHECK(timepoint::cruise_cables_cut.value < timepoint::cruise_stage_separation.value);
}

TEST_CASE("the timeline powers devices and sets telecom", "[timeline][R28]") {
    Fixture f;
    action_named<"power_on_radar">().run(f.context);
    action_named<"start_uhf">().run(f.context);
    action_named<"select_entry_antenna">().run(f.context);
    action_named<"start_x_band_tones">().run(f.context);
    const auto switches = f.recorder.sent<SetSwitch>();
    REQUIRE(switches.size() == 4);
    CHECK(switches[0].id == SwitchId::radar);
    CHECK(switches[1].id == SwitchId::uhf);
    CHECK(switches[2].id == SwitchId::entry_antenna);
    CHECK(switches[3].id == SwitchId::x_band_tones);
    CHECK(f.context.awaited() ==
          ActionReply{ReplyKind::device_switch, static_cast<std::uint8_t>(SwitchId::x_band_tones), Evidence::none});
}

}  // namespace flight_actions_test
