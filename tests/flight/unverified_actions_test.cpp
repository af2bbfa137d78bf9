// SPDX-License-Identifier: Apache-2.0
#include "flight/edl/unverified_actions.hpp"

#include "flight/timeline/actions.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"

namespace flight_unverified_actions_test {

using namespace aeolis;
using namespace aeolis::flight;
constexpr aeolis::flight::Parameters parameters;

namespace {

constexpr ActionReply mortar{ReplyKind::pyro, static_cast<std::uint8_t>(PyroId::parachute_mortar)};

/// The mortar was commanded at 1000 s, and nothing answered within its second: taken as done. Or it was refused, or
/// verified.
struct Fixture {
    UnverifiedActions actions;
    gnc::Configuration configuration;
    test::OutboxRecorder recorder;

    explicit Fixture(FiringVerdict verdict = FiringVerdict::unverified) {
        if (verdict != FiringVerdict::refused) configuration.learn(gnc::Fact::parachute_out, Sclk{1000.0});
        actions.add(
            {timepoint::parachute_deploy, Sclk{1000.0}, Sclk{1001.0}, verdict, mortar, gnc::Fact::parachute_out});
    }
    bool reply(Evidence evidence, double at_s) {
        recorder.begin(ModuleId::edl, Sclk{at_s});
        ActionContext context{recorder.out, configuration};
        ActionReply reply = mortar;
        reply.evidence = evidence;
        return actions.on(reply, context);
    }
    void feel(double force_mps2, double at_s, double imu_silent_s = 0.0) {
        recorder.begin(ModuleId::edl, Sclk{at_s});
        gnc::Output told;
        told.acceleration_B_mps2 = {0.0, 0.0, -force_mps2};
        told.dead_reckoned_s = imu_silent_s;
        actions.watch(parameters, told, configuration, recorder.out);
    }
};

}  // namespace

TEST_CASE("a reply that comes after the time-out is told, with what its row announces, once", "[edl][R50]") {
    Fixture f;
    CHECK(f.reply(Evidence::verified, 1003.0));
    CHECK(f.recorder.events<evr::TIMEPOINT_VERIFIED_LATE>() == 1);
    REQUIRE(f.recorder.sent<ToneRequest>().size() == 1);
    CHECK(f.recorder.sent<ToneRequest>()[0].tone == tone::parachute_deploy);
    CHECK(f.configuration.parachute_time == Sclk{1000.0});
    CHECK_FALSE(f.reply(Evidence::verified, 1004.0));
    CHECK(f.recorder.out.sent().empty());
}

TEST_CASE("a late reply about the other state of a switch is not its reply", "[edl][R50]") {
    Fixture f;
    const ActionReply uhf_on{ReplyKind::device_switch, static_cast<std::uint8_t>(SwitchId::uhf)};
    ActionReply uhf_off = uhf_on;
    uhf_off.on = false;
    f.actions.add({timepoint::uhf_start, Sclk{900.0}, Sclk{912.0}, FiringVerdict::unverified, uhf_on, {}});
    f.recorder.begin(ModuleId::edl, Sclk{1000.0});
    ActionContext context{f.recorder.out, f.configuration};
    CHECK_FALSE(f.actions.on(uhf_off, context));
    CHECK(f.actions.on(uhf_on, context));
}

TEST_CASE("a refusal that comes after the time-out takes back what was taken as done, and is explained",
          "[edl][R38][R50]") {
    Fixture f;
    CHECK(f.reply(Evidence::refused, 1003.0));
    CHECK(f.recorder.events<evr::TIMEPOINT_REFUSED>() == 1);
    CHECK(f.recorder.packets<packet::Explanation>() == 1);
    CHECK(f.recorder.sent<ToneRequest>()[0].tone == tone::pyro_not_fired);
    CHECK_FALSE(f.configuration.parachute_out);
}

TEST_CASE("a snatch that the IMU feels bears out a mortar that did not answer", "[edl][R50]") {
    Fixture f;
    f.feel(6.0, 1001.5);
    CHECK(f.recorder.out.sent().empty());
    f.feel(40.0, 1001.8);
    CHECK(f.recorder.events<evr::TIMEPOINT_FELT>() == 1);
    for (const double at_s : {1002.0, 1003.0, 1004.0}) f.feel(4.0, at_s);
    CHECK(f.recorder.out.sent().empty());
    CHECK(f.configuration.parachute_out);
}

TEST_CASE("without a snatch in time the IMU contradicts, GNC has no parachute, and it is told and explained",
          "[edl][R38][R50]") {
    Fixture f;
    f.feel(6.0, 1000.0 + parameters.parachute_felt_within_s - 1.0 / 64);
    CHECK(f.recorder.out.sent().empty());
    f.feel(6.0, 1000.0 + parameters.parachute_felt_within_s);
    CHECK(f.recorder.events<evr::TIMEPOINT_CONTRADICTED>() == 1);
    CHECK(f.recorder.packets<packet::Explanation>() == 1);
    CHECK(f.recorder.sent<ToneRequest>()[0].tone == tone::pyro_not_fired);
    CHECK_FALSE(f.configuration.parachute_out);
    f.feel(6.0, 1004.0);
    CHECK(f.recorder.out.sent().empty());
    CHECK(f.reply(Evidence::verified, 1005.0));  // it fired after all
    CHECK(f.configuration.parachute_out);
}

TEST_CASE("a mortar that was refused and that the IMU feels has fired, and that is told and announced", "[edl][R50]") {
    Fixture f{FiringVerdict::refused};
    f.feel(6.0, 1001.5);
    CHECK(f.recorder.out.sent().empty());
    CHECK_FALSE(f.configuration.parachute_out);
    f.feel(40.0, 1001.8);
    CHECK(f.recorder.events<evr::TIMEPOINT_FELT>() == 1);
    REQUIRE(f.recorder.sent<ToneRequest>().size() == 1);
    CHECK(f.recorder.sent<ToneRequest>()[0].tone == tone::parachute_deploy);
    CHECK(f.configuration.parachute_time == Sclk{1000.0});
    f.feel(40.0, 1003.5);
    CHECK(f.recorder.out.sent().empty());
}

TEST_CASE("a mortar that was refused and that nobody feels was told already", "[edl][R50]") {
    Fixture f{FiringVerdict::refused};
    f.feel(6.0, 1000.0 + parameters.parachute_felt_within_s);
    CHECK(f.recorder.out.sent().empty());
    CHECK_FALSE(f.configuration.parachute_out);
}

TEST_CASE("a mortar that is said to have fired and that the IMU does not feel is contradicted, told and explained; GNC "
          "flies on as said",
          "[edl][R38][R50]") {
    Fixture f{FiringVerdict::verified};
    f.feel(6.0, 1001.5);
    CHECK(f.recorder.out.sent().empty());
    f.feel(6.0, 1000.0 + parameters.parachute_felt_within_s);
    CHECK(f.recorder.events<evr::TIMEPOINT_CONTRADICTED>() == 1);
    CHECK(f.recorder.packets<packet::Explanation>() == 1);
    CHECK(f.recorder.sent<ToneRequest>()[0].tone == tone::pyro_not_fired);
    CHECK(f.configuration.parachute_out);

    Fixture felt{FiringVerdict::verified};
    felt.feel(40.0, 1001.8);
    felt.feel(6.0, 1004.0);
    CHECK(felt.recorder.out.sent().empty());
    CHECK_FALSE(felt.reply(Evidence::verified, 1004.0));  // of nothing that is awaited
}

TEST_CASE("an IMU that was silent neither bears out a mortar nor contradicts it: the mortar stays unverified",
          "[edl][R50]") {
    Fixture f;
    f.feel(40.0, 1001.5, 0.5);  // reckoned by the model of a parachute
    CHECK(f.recorder.out.sent().empty());
    f.feel(4.0, 1000.0 + parameters.parachute_felt_within_s);
    CHECK(f.recorder.events<evr::TIMEPOINT_FELT>() == 0);
    CHECK(f.recorder.events<evr::TIMEPOINT_CONTRADICTED>() == 0);
    CHECK(f.recorder.out.sent().empty());
    CHECK(f.configuration.parachute_out);
}

TEST_CASE("each way in which an action ends has an event of its own; what was not done has a tone and an explanation",
          "[edl][R38][R50]") {
    const TimepointSpec& row = timeline_specs[timepoint::parachute_deploy.value];
    const auto told = [&](FiringVerdict verdict, ActionReply asked = mortar) {
        auto recorder = std::make_unique<test::OutboxRecorder>();
        tell_reply({timepoint::parachute_deploy, Sclk{1000.0}, Sclk{1001.0}, verdict, asked, {}}, row, recorder->out);
        return recorder;
    };
    const auto tone_of = [](const auto& recorder) {
        const auto sent = recorder->template sent<ToneRequest>();
        return sent.empty() ? std::nullopt : std::optional{sent[0].tone};
    };
    CHECK(told(FiringVerdict::completed)->out.sent().empty());
    CHECK(told(FiringVerdict::no_operation)->out.sent().empty());

    const auto verified = told(FiringVerdict::verified);
    CHECK(verified->events<evr::TIMEPOINT_VERIFIED>() == 1);
    CHECK(verified->out.sent().size() == 1);

    const auto refused = told(FiringVerdict::refused);
    CHECK(refused->events<evr::TIMEPOINT_REFUSED>() == 1);
    CHECK(refused->packets<packet::Explanation>() == 1);
    CHECK(tone_of(refused) == tone::pyro_not_fired);
    CHECK(tone_of(told(FiringVerdict::refused, {ReplyKind::device_switch, 0})) == tone::action_refused);

    const auto unverified = told(FiringVerdict::unverified);
    CHECK(unverified->events<evr::TIMEPOINT_UNVERIFIED>() == 1);
    CHECK(unverified->packets<packet::Explanation>() == 1);
    CHECK(tone_of(unverified) == tone::action_unverified);
}

TEST_CASE("of more unverified actions than are kept the oldest is given up", "[edl][R50]") {
    Fixture f;
    for (std::uint16_t i = 0; i < 16; ++i)
        f.actions.add({TimepointId{i},
                       Sclk{1000.0},
                       Sclk{1001.0},
                       FiringVerdict::unverified,
                       {ReplyKind::device_switch, static_cast<std::uint8_t>(i)},
                       {}});
    CHECK_FALSE(f.reply(Evidence::verified, 1002.0));
}

}  // namespace flight_unverified_actions_test
