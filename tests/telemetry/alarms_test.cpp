#include "telemetry/alarms.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/small_dictionary.hpp"

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

} // namespace

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
