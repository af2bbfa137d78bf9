// SPDX-License-Identifier: Apache-2.0
#include "telemetry/alarms.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/small_dictionary.hpp"

namespace telemetry_alarms_test {

using namespace aeolis;
using namespace aeolis::telemetry;
using dictionary::Severity;

namespace {

// Warning above 600 m/s, critical above 700 m/s or below -1 m/s, two samples in a row.
struct Speed {
    dictionary::Dictionary dictionary = tests::small_dictionary();
    AlarmMonitor monitor{dictionary};
    ChannelId channel = dictionary.channel("speed_mps")->id;
    std::vector<AlarmChange> changes;
    double sclk = 1000.0;

    Severity after(double value) {
        monitor.sample(channel, value, Sclk{sclk += 1.0}, changes);
        return monitor.severity(channel);
    }
};

}  // namespace

TEST_CASE("an alarm is raised by as many samples in a row as the dictionary asks for", "[alarms]") {
    Speed speed;
    CHECK(speed.after(600.0) == Severity::none);
    CHECK(speed.after(600.1) == Severity::none);
    CHECK(speed.after(599.0) == Severity::none);
    CHECK(speed.after(601.0) == Severity::none);
    CHECK(speed.after(602.0) == Severity::warning);
    REQUIRE(speed.changes.size() == 1);
    CHECK(speed.changes[0].limit == "> 600.0 m/s");
    CHECK(speed.changes[0].value == 602.0);
    CHECK(speed.changes[0].sclk == Sclk{1005.0});
}

TEST_CASE("one sample within the limits clears an alarm", "[alarms]") {
    Speed speed;
    speed.after(650.0);
    speed.after(650.0);
    CHECK(speed.after(600.0) == Severity::none);
    REQUIRE(speed.changes.size() == 2);
    CHECK(speed.changes[1].before == Severity::warning);
    CHECK(speed.changes[1].limit.empty());
}

TEST_CASE("an alarm grows and shrinks by samples in a row of that severity", "[alarms]") {
    Speed speed;
    speed.after(650.0);
    CHECK(speed.after(701.0) == Severity::warning);
    CHECK(speed.after(702.0) == Severity::critical);
    CHECK(speed.changes.back().limit == "> 700.0 m/s");
    CHECK(speed.after(650.0) == Severity::warning);
    CHECK(speed.after(0.0) == Severity::none);
    CHECK(speed.changes.size() == 4);
}

TEST_CASE("a limit below is told with its own sign", "[alarms]") {
    Speed speed;
    CHECK(speed.after(-1.0) == Severity::none);
    speed.after(-1.5);
    CHECK(speed.after(-1.5) == Severity::critical);
    CHECK(speed.changes.back().limit == "< -1.0 m/s");
}

TEST_CASE("the value of an enumeration can be an alarm", "[alarms]") {
    Speed mission;
    mission.channel = mission.dictionary.channel("edl_phase")->id;
    CHECK(mission.after(1.0) == Severity::none);
    CHECK(mission.after(2.0) == Severity::severe);
    CHECK(mission.changes.back().limit == "= landed");
}

TEST_CASE("a channel without limits never alarms", "[alarms]") {
    Speed mission;
    mission.channel = mission.dictionary.channel("altitude_m")->id;
    CHECK(mission.after(-1e30) == Severity::none);
    CHECK(mission.changes.empty());
}

TEST_CASE("an alarm that asks for conformance clears only after as many samples within the limits", "[alarms]") {
    Speed speed;
    speed.dictionary.channels[speed.channel.value].type.alarms.min_conformance = 3;
    speed.after(650.0);
    CHECK(speed.after(650.0) == Severity::warning);
    CHECK(speed.after(500.0) == Severity::warning);
    CHECK(speed.after(500.0) == Severity::warning);
    CHECK(speed.after(601.0) == Severity::warning);  // begins again
    CHECK(speed.after(500.0) == Severity::warning);
    CHECK(speed.after(500.0) == Severity::warning);
    CHECK(speed.after(500.0) == Severity::none);
    CHECK(speed.changes.size() == 2);
}

namespace {

// Under the parachute the speed is limited to 200 m/s, two samples in a row; else as in Speed.
struct InContext : Speed {
    ChannelId phase = dictionary.channel("edl_phase")->id;
    InContext() {
        dictionary::ContextAlarms under_parachute;
        under_parachute.context = {{phase, "==", 1.0, ""}};
        under_parachute.alarms.ranges = {{Severity::critical, {}, 200.0}};
        under_parachute.alarms.min_violations = 2;
        dictionary.channels[channel.value].type.alarms.contexts = {under_parachute};
    }
    void enter(double value) { monitor.sample(phase, value, Sclk{sclk}, changes); }
};

}  // namespace

TEST_CASE("limits are those of the phase: what is right in one is an alarm in the next", "[alarms]") {
    InContext mission;
    CHECK(mission.after(400.0) == Severity::none);
    CHECK(mission.after(400.0) == Severity::none);
    mission.enter(1.0);
    CHECK(mission.after(400.0) == Severity::none);  // counting begins with the context
    CHECK(mission.after(400.0) == Severity::critical);
    CHECK(mission.changes.back().limit == "> 200.0 m/s in parachute_descent");
    mission.enter(0.0);
    CHECK(mission.after(400.0) == Severity::none);
    CHECK(mission.after(650.0) == Severity::none);
    CHECK(mission.after(650.0) == Severity::warning);
    CHECK(mission.changes.back().limit == "> 600.0 m/s");
}

TEST_CASE("before the phase is known the default limits count", "[alarms]") {
    InContext mission;
    mission.after(650.0);
    CHECK(mission.after(650.0) == Severity::warning);
}

TEST_CASE("the shipped dictionary has limits by phase for load and descent rate, and the load's latches",
          "[alarms][dictionary]") {
    const auto& shipped = tests::shipped_dictionary();
    const auto phases_of = [&](const char* name) {
        std::string phases;
        for (const auto& [context, alarms] : shipped.channel(name)->type.alarms.contexts)
            phases += context_text(shipped, context) + " ";
        return phases;
    };
    CHECK(phases_of("sensed_deceleration_g") == "parachute_descent powered_descent sky_crane ");
    CHECK(phases_of("descent_rate_mps") == "parachute_descent powered_descent sky_crane ");
    CHECK(latches(shipped.channel("sensed_deceleration_g")->type.alarms));
    CHECK_FALSE(latches(shipped.channel("descent_rate_mps")->type.alarms));
}

}  // namespace telemetry_alarms_test
