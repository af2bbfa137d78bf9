// SPDX-License-Identifier: Apache-2.0
#include "flight/edl/unverified_actions.hpp"

#include "flight/cross_string/state_exchange.hpp"
#include "flight/timeline/actions.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"

#include <array>
#include <utility>

namespace flight_unverified_actions_test {

using namespace aeolis;
using namespace aeolis::flight;
constexpr aeolis::flight::Parameters parameters;

namespace {

constexpr ActionReply pyro(PyroId id) {
    return {ReplyKind::pyro, static_cast<std::uint8_t>(id)};
}
constexpr ActionReply mortar = pyro(PyroId::parachute_mortar);
const int cycles_needed = static_cast<int>(parameters.action_felt_cycles);

/// The mortar was commanded at 1000 s, and nothing answered within its second: taken as done. Or it was refused, or
/// verified.
struct Fixture {
    UnverifiedActions actions;
    gnc::Configuration configuration;
    test::OutboxRecorder recorder;

    explicit Fixture(FiringVerdict verdict = FiringVerdict::unverified, double before_mps2 = 6.0) {
        feel(before_mps2, 1000.9);
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
    void hear(const gnc::Output& told, double at_s, double bridle_m = 0.0) {
        recorder.begin(ModuleId::edl, Sclk{at_s});
        actions.watch(parameters, told, bridle_m, configuration, recorder.out);
    }
    static gnc::Output felt(double force_mps2, double imu_silent_s = 0.0) {
        gnc::Output told;
        told.acceleration_B_mps2 = {0.0, 0.0, -force_mps2};
        told.dead_reckoned_s = imu_silent_s;
        told.imu_heard = imu_silent_s == 0.0;
        return told;
    }
    void feel(double force_mps2, double at_s, double imu_silent_s = 0.0) { hear(felt(force_mps2, imu_silent_s), at_s); }
    /// For as long as it takes to be evidence; the recorder holds the last cycle.
    void feel_on(double force_mps2, double from_s, double imu_silent_s = 0.0) {
        for (int cycle = 0; cycle < cycles_needed; ++cycle)
            feel(force_mps2, from_s + cycle * seconds_per_tick, imu_silent_s);
    }
};

/// An action of another row that was refused at 1001 s.
Fixture refused(TimepointId timepoint, PyroId id, gnc::Fact fact) {
    Fixture f{FiringVerdict::refused};
    f.actions = {};
    f.actions.add({timepoint, Sclk{1000.0}, Sclk{1001.0}, FiringVerdict::refused, pyro(id), fact});
    return f;
}

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
    CHECK(f.recorder.sent<ToneRequest>()[0].tone == tone::pyro_refused);
    CHECK_FALSE(f.configuration.parachute_out);
}

TEST_CASE("a snatch that the IMU feels bears out a mortar that did not answer, and it is announced as done",
          "[edl][R38][R50]") {
    Fixture f;
    f.feel(6.0, 1001.5);
    CHECK(f.recorder.out.sent().empty());
    f.feel_on(40.0, 1001.8);
    CHECK(f.recorder.events<evr::TIMEPOINT_FELT>() == 1);
    REQUIRE(f.recorder.explanations().size() == 1);
    CHECK(f.recorder.explanations()[0].verdict == ExplanationVerdict::borne_out);
    REQUIRE(f.recorder.sent<ToneRequest>().size() == 1);
    CHECK(f.recorder.sent<ToneRequest>()[0].tone == tone::parachute_deploy);
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
    CHECK(f.recorder.sent<ToneRequest>()[0].tone == tone::action_contradicted);
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
    f.feel_on(40.0, 1001.8);
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
    CHECK(f.recorder.sent<ToneRequest>()[0].tone == tone::action_contradicted);
    CHECK(f.configuration.parachute_out);

    Fixture felt{FiringVerdict::verified};
    felt.feel_on(40.0, 1001.8);
    felt.feel(6.0, 1004.0);
    CHECK(felt.recorder.out.sent().empty());
    CHECK_FALSE(felt.reply(Evidence::verified, 1004.0));  // of nothing that is awaited
}

TEST_CASE("an IMU that was silent neither bears out a mortar nor contradicts it: the mortar stays unverified",
          "[edl][R50]") {
    Fixture f;
    f.feel_on(40.0, 1001.5, 0.5);  // reckoned by the model of a parachute
    CHECK(f.recorder.out.sent().empty());
    f.feel(4.0, 1000.0 + parameters.parachute_felt_within_s);
    CHECK(f.recorder.events<evr::TIMEPOINT_FELT>() == 0);
    CHECK(f.recorder.events<evr::TIMEPOINT_CONTRADICTED>() == 0);
    CHECK(f.recorder.out.sent().empty());
    CHECK(f.configuration.parachute_out);
}

TEST_CASE("a single increment is no evidence: the IMU must feel the parachute for some cycles in a row", "[edl][R50]") {
    Fixture f;
    for (int cycle = 0; cycle < 3 * cycles_needed; ++cycle)
        f.feel(cycle % cycles_needed == 0 ? 6.0 : 40.0, 1001.0 + cycle * seconds_per_tick);
    CHECK(f.recorder.events<evr::TIMEPOINT_FELT>() == 0);
    f.feel(6.0, 1000.0 + parameters.parachute_felt_within_s);
    CHECK(f.recorder.events<evr::TIMEPOINT_CONTRADICTED>() == 1);

    Fixture spike;
    spike.feel(40.0, 1000.0 + parameters.parachute_felt_within_s);  // the parachute may be opening just now
    CHECK(spike.recorder.out.sent().empty());
    spike.feel(6.0, 1000.0 + parameters.parachute_felt_within_s + seconds_per_tick);
    CHECK(spike.recorder.events<evr::TIMEPOINT_CONTRADICTED>() == 1);
}

TEST_CASE("a tick without increments neither is evidence nor breaks it", "[edl][R50]") {
    Fixture f;
    for (int cycle = 0; cycle + 1 < cycles_needed; ++cycle) f.feel(40.0, 1001.8 + cycle * seconds_per_tick);
    f.feel(40.0, 1001.95, seconds_per_tick);  // a garbled message: GNC reckons
    CHECK(f.recorder.events<evr::TIMEPOINT_FELT>() == 0);
    f.feel(40.0, 1001.97);
    CHECK(f.recorder.events<evr::TIMEPOINT_FELT>() == 1);
}

TEST_CASE("where as much was felt before the mortar could act, the IMU neither bears it out nor contradicts it",
          "[edl][R50]") {
    for (const double before_mps2 : {parameters.parachute_felt_mps2, 100.0}) {
        Fixture f{FiringVerdict::unverified, before_mps2};
        f.feel_on(before_mps2, 1001.0);
        CHECK(f.recorder.events<evr::TIMEPOINT_FELT>() == 0);
        f.feel(4.0, 1000.0 + parameters.parachute_felt_within_s);
        CHECK(f.recorder.out.sent().empty());
        CHECK(f.configuration.parachute_out);
    }
    Fixture below{FiringVerdict::unverified, 0.99 * parameters.parachute_felt_mps2};
    below.feel_on(40.0, 1001.8);
    CHECK(below.recorder.events<evr::TIMEPOINT_FELT>() == 1);
}

TEST_CASE("a refusal that comes late takes nothing back that the IMU has borne out, and is told", "[edl][R50]") {
    Fixture f;
    f.feel_on(40.0, 1001.8);
    CHECK(f.reply(Evidence::refused, 1002.5));
    CHECK(f.recorder.events<evr::REPLY_CONTRADICTS>() == 1);
    CHECK(f.recorder.events<evr::TIMEPOINT_REFUSED>() == 0);
    CHECK(f.configuration.parachute_out);

    Fixture before;  // it comes before the parachute opens
    CHECK(before.reply(Evidence::refused, 1001.5));
    CHECK_FALSE(before.configuration.parachute_out);
    before.feel_on(40.0, 1001.8);
    CHECK(before.recorder.events<evr::TIMEPOINT_FELT>() == 1);
    CHECK(before.configuration.parachute_time == Sclk{1000.0});
}

TEST_CASE("a computer that takes over hears the witnesses further, and contradicts nothing that it may have missed",
          "[edl][R33][R50]") {
    const auto taken_over = [](Fixture f) {
        std::array<std::uint8_t, 1024> octets{};
        StateExchange<std::uint8_t> to{octets};
        to(f.actions);
        REQUIRE(to.ok());
        UnverifiedActions other;
        StateExchange<const std::uint8_t> from{octets};
        from(other);
        REQUIRE(from.size() == to.size());
        other.miss_some();
        f.actions = other;
        return f;
    };
    Fixture mortar = taken_over(Fixture{FiringVerdict::refused});
    mortar.feel_on(40.0, 1001.8);
    CHECK(mortar.recorder.events<evr::TIMEPOINT_FELT>() == 1);
    CHECK(mortar.configuration.parachute_time == Sclk{1000.0});

    Fixture heatshield = taken_over(
        refused(timepoint::heatshield_separation, PyroId::heatshield_separation, gnc::Fact::heatshield_gone));
    gnc::Output told = Fixture::felt(4.0);
    told.radar_locked = true;
    heatshield.hear(told, 1006.0);
    CHECK(heatshield.recorder.events<evr::TIMEPOINT_WITNESSED>() == 1);
    CHECK(heatshield.configuration.heatshield_gone);

    Fixture missed = taken_over(Fixture{});  // the snatch may have come while nobody listened
    missed.feel(6.0, 1000.0 + parameters.parachute_felt_within_s);
    CHECK(missed.recorder.out.sent().empty());
    CHECK(missed.configuration.parachute_out);
}

TEST_CASE("a verification that comes after a refusal was final is told, learnt and announced, once", "[edl][R50]") {
    Fixture f = refused(timepoint::cruise_stage_separation, PyroId::cruise_stage_separation,
                        gnc::Fact::cruise_stage_gone);  // no witness
    const auto reply = [&](Evidence evidence) {
        ActionReply said = pyro(PyroId::cruise_stage_separation);
        said.evidence = evidence;
        f.recorder.begin(ModuleId::edl, Sclk{1001.5});
        ActionContext context{f.recorder.out, f.configuration};
        return f.actions.on(said, context);
    };
    CHECK_FALSE(reply(Evidence::refused));  // told already
    CHECK(f.recorder.out.sent().empty());
    CHECK_FALSE(f.configuration.cruise_stage_gone);
    CHECK(reply(Evidence::verified));
    CHECK(f.recorder.events<evr::TIMEPOINT_VERIFIED_LATE>() == 1);
    CHECK(f.recorder.events<evr::CRUISE_STAGE_SEPARATION>() == 1);
    CHECK(f.recorder.sent<ToneRequest>()[0].tone == tone::cruise_stage_separation);
    CHECK(f.configuration.cruise_stage_gone);
    CHECK_FALSE(reply(Evidence::verified));
    CHECK(f.recorder.out.sent().empty());
}

TEST_CASE("a reply that comes late is that of the newest action that asked for it", "[edl][R50]") {
    Fixture f;
    f.actions = {};
    const ActionReply on{ReplyKind::thrusters, 0, Evidence::none, true};
    for (const auto& [timepoint, at_s] : {std::pair{timepoint::thrusters_enable, 500.0}, {timepoint::detumble, 510.0}})
        f.actions.add({timepoint, Sclk{at_s}, Sclk{at_s + 1.0}, FiringVerdict::refused, on, gnc::Fact::thrusters_on});
    f.recorder.begin(ModuleId::edl, Sclk{512.0});
    ActionContext context{f.recorder.out, f.configuration};
    CHECK(f.actions.on({ReplyKind::thrusters, 0, Evidence::verified, true}, context));
    CHECK(f.configuration.thrusters_on_time == Sclk{510.0});
}

TEST_CASE("a refused separation of the heatshield has happened once the radar sees the ground", "[edl][R50]") {
    Fixture f = refused(timepoint::heatshield_separation, PyroId::heatshield_separation, gnc::Fact::heatshield_gone);
    gnc::Output told = Fixture::felt(4.0);
    f.hear(told, 1005.0);
    CHECK(f.recorder.out.sent().empty());
    told.radar_locked = true;
    f.hear(told, 1006.0);
    CHECK(f.recorder.events<evr::TIMEPOINT_WITNESSED>() == 1);
    CHECK(f.recorder.packets<packet::Explanation>() == 1);
    REQUIRE(f.recorder.sent<ToneRequest>().size() == 1);
    CHECK(f.recorder.sent<ToneRequest>()[0].tone == tone::heatshield_separation);
    CHECK(f.configuration.heatshield_time == Sclk{1000.0});
    f.hear(told, 1007.0);
    CHECK(f.recorder.out.sent().empty());
}

TEST_CASE("refused valves of the engines are open once their controllers report", "[edl][R50]") {
    Fixture f = refused(timepoint::engine_priming, PyroId::engine_valves, gnc::Fact::engines_primed);
    gnc::Output told;
    f.hear(told, 1001.5);
    CHECK_FALSE(f.configuration.engines_primed);
    told.engines_heard = true;
    f.hear(told, 1002.0);
    CHECK(f.recorder.events<evr::TIMEPOINT_WITNESSED>() == 1);
    CHECK(f.configuration.engines_primed);
}

TEST_CASE("a refused separation of the backshell has happened once the IMU feels a free fall, while it measures",
          "[edl][R50]") {
    const auto fixture = [] {
        return refused(timepoint::backshell_separation, PyroId::backshell_separation, gnc::Fact::backshell_gone);
    };
    Fixture f = fixture();
    f.feel_on(3.7, 1001.0);
    CHECK(f.recorder.out.sent().empty());
    f.feel_on(1.01 * parameters.free_fall_felt_mps2, 1001.2);
    CHECK_FALSE(f.configuration.backshell_gone);
    f.feel_on(parameters.free_fall_felt_mps2, 1001.4);
    CHECK(f.recorder.events<evr::TIMEPOINT_WITNESSED>() == 1);
    CHECK(f.configuration.backshell_time == Sclk{1000.0});

    Fixture reckoned = fixture();
    reckoned.feel_on(0.0, 1001.0, 0.5);
    CHECK_FALSE(reckoned.configuration.backshell_gone);
    Fixture single_one = fixture();
    single_one.feel(0.0, 1001.0);
    single_one.feel(3.7, 1001.1);
    CHECK_FALSE(single_one.configuration.backshell_gone);
}

TEST_CASE("a rover that is refused to have separated has once the bridle is paid out", "[edl][R50]") {
    Fixture f = refused(timepoint::rover_separation, PyroId::rover_separation, gnc::Fact::rover_separated);
    f.hear({}, 1001.5, parameters.bridle_felt_m - 0.01);
    CHECK_FALSE(f.configuration.rover_separated);
    f.hear({}, 1001.6, parameters.bridle_felt_m);
    CHECK(f.recorder.events<evr::TIMEPOINT_WITNESSED>() == 1);
    CHECK(f.configuration.rover_separation_time == Sclk{1000.0});
}

TEST_CASE("an action that was taken as done is announced once: by its witness, and not again by a reply that follows",
          "[edl][R38][R50]") {
    Fixture f{FiringVerdict::refused};
    f.actions = {};
    f.configuration.learn(gnc::Fact::engines_primed, Sclk{1000.0});
    f.actions.add({timepoint::engine_priming, Sclk{1000.0}, Sclk{1002.0}, FiringVerdict::unverified,
                   pyro(PyroId::engine_valves), gnc::Fact::engines_primed});
    gnc::Output told;
    told.engines_heard = true;
    f.hear(told, 1002.5);
    CHECK(f.recorder.events<evr::TIMEPOINT_WITNESSED>() == 1);
    REQUIRE(f.recorder.sent<ToneRequest>().size() == 1);
    CHECK(f.recorder.sent<ToneRequest>()[0].tone == tone::engine_priming);
    const auto explanations = f.recorder.explanations();
    REQUIRE(explanations.size() == 1);
    CHECK(explanations[0].verdict == ExplanationVerdict::borne_out);
    CHECK(explanations[0].conditions.size() == 1);  // believed at once: there is no count
    f.hear(told, 1002.6);
    CHECK(f.recorder.out.sent().empty());
    f.recorder.begin(ModuleId::edl, Sclk{1003.0});
    ActionContext context{f.recorder.out, f.configuration};
    CHECK(f.actions.on(pyro(PyroId::engine_valves), context));
    CHECK(f.recorder.events<evr::TIMEPOINT_VERIFIED_LATE>() == 1);
    CHECK(f.recorder.sent<ToneRequest>().empty());
    CHECK(f.configuration.engines_primed);
}

TEST_CASE("thrusters should obey from their command on, once it is not refused, until they are commanded off",
          "[edl][timeline][R50]") {
    Fixture f;
    f.recorder.begin(ModuleId::edl, Sclk{1000.0});
    ActionContext context{f.recorder.out, f.configuration};
    action_named<"enable_thrusters">().run(context);
    CHECK(context.fact() == gnc::Fact::thrusters_on);
    CHECK_FALSE(f.configuration.thrusters_on_time);  // its reply is due
    f.configuration.learn(gnc::Fact::thrusters_on, Sclk{1000.0});
    f.configuration.learn(gnc::Fact::thrusters_on, Sclk{1010.0});  // commanded once more
    CHECK(f.configuration.thrusters_on_time == Sclk{1000.0});
    action_named<"disable_thrusters">().run(context);
    CHECK_FALSE(f.configuration.thrusters_on_time);  // whatever is answered
    f.configuration.learn(gnc::Fact::thrusters_on, Sclk{1020.0});
    f.configuration.forget(gnc::Fact::thrusters_on);
    CHECK_FALSE(f.configuration.thrusters_on_time);
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
    CHECK(tone_of(refused) == tone::pyro_refused);
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
