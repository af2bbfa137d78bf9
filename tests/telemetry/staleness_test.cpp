// SPDX-License-Identifier: Apache-2.0
#include "telemetry/staleness.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/small_dictionary.hpp"

namespace telemetry_staleness_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

constexpr std::size_t status = 0, held = 1;

constexpr Ert at_s(double seconds) {
    return Ert{static_cast<std::int64_t>(seconds * 1e6)};
}

// Status: 1 Hz recorded; of it every 2nd before entry, every 4th in entry, none on the ground. ParametersHeld: no rate.
struct Ground {
    dictionary::Dictionary dictionary = make();
    StalenessMonitor monitor{dictionary};
    std::vector<StalenessChange> changes;

    static dictionary::Dictionary make() {
        auto dictionary = tests::small_dictionary();
        dictionary.packets[status].expected_rate_hz = 1.0;
        dictionary.telemetry_plan = {
            {"all", "Status", tests::status_apid, dictionary::TelemetryPriority::high, {2, 4, 4, 0}, 1, "", 2}};
        return dictionary;
    }
    Ground() {
        monitor.link("uhf_live", LinkIs::up, "nominal", at_s(0.0), changes);
        monitor.phase("late_cruise", at_s(0.0), changes);
    }
    void hear(double s) { monitor.heard(status, at_s(s), changes); }
    std::size_t after(double s) {
        monitor.pass(at_s(s), changes);
        return changes.size();
    }
};

}  // namespace

TEST_CASE("a packet is stale when four of its intervals bring nothing, and not before", "[alarms][staleness]") {
    Ground ground;
    ground.hear(1.0);
    CHECK(ground.after(9.0) == 0);
    REQUIRE(ground.after(9.5) == 1);
    CHECK(ground.changes[0].packet == status);
    CHECK(ground.changes[0].is == Staleness::missing);
    CHECK(ground.changes[0].silent_s == 8.5);
    CHECK(ground.changes[0].expected_s == 2.0);
    CHECK(ground.after(30.0) == 1);  // said once
    ground.hear(31.0);
    REQUIRE(ground.changes.size() == 2);
    CHECK(ground.changes[1].is == Staleness::current);
    CHECK(ground.changes[1].reason == "heard again");
}

TEST_CASE("silence while the link is down is the link's: all is stale with that reason, and nothing is missing",
          "[alarms][staleness]") {
    Ground ground;
    ground.hear(1.0);
    ground.monitor.heard(held, at_s(1.0), ground.changes);
    ground.monitor.link("uhf_live", LinkIs::down, "plasma blackout", at_s(3.0), ground.changes);
    CHECK(ground.after(3.9) == 0);  // another link may take over
    REQUIRE(ground.after(4.0) == 2);
    for (const auto& change : ground.changes) {
        CHECK(change.is == Staleness::explained);
        CHECK(change.silent_s == 3.0);
        CHECK(change.expected_s == 0.0);
        CHECK(change.reason == "the link is down: plasma blackout");
    }
    CHECK(ground.after(90.0) == 2);  // said once
    ground.monitor.link("uhf_live", LinkIs::up, "nominal", at_s(90.0), ground.changes);
    CHECK(ground.after(98.0) == 2);
    REQUIRE(ground.after(98.5) == 3);
    CHECK(ground.changes[2].is == Staleness::missing);
    ground.monitor.link("uhf_live", LinkIs::down, "Earth set", at_s(99.0), ground.changes);
    REQUIRE(ground.changes.size() == 4);
    CHECK(ground.changes[3].is == Staleness::explained);
    CHECK(ground.changes[3].reason == "the link is down: Earth set");
    ground.monitor.heard(held, at_s(100.0), ground.changes);
    REQUIRE(ground.changes.size() == 5);
    CHECK(ground.changes[4].is == Staleness::current);
}

TEST_CASE("one of two links is enough to be heard over, and one that brings no packets is none",
          "[alarms][staleness]") {
    Ground ground;
    ground.hear(1.0);
    ground.monitor.link("uhf_mro", LinkIs::up, "nominal", at_s(2.0), ground.changes);
    ground.monitor.link("uhf_live", LinkIs::down, "hand-over", at_s(3.0), ground.changes);
    ground.monitor.link("x_band", LinkIs::up, "nominal", at_s(3.0), ground.changes);
    CHECK(ground.after(9.5) == 1);
    ground.monitor.link("uhf_mro", LinkIs::down, "no orbiter in view", at_s(10.0), ground.changes);
    REQUIRE(ground.changes.size() == 2);
    CHECK(ground.changes[1].reason == "the link is down: no orbiter in view");
    CHECK(ground.after(60.0) == 2);
}

TEST_CASE("a link that is lost takes no alarm away, and what it does not bring becomes one with its reason",
          "[alarms][staleness]") {
    Ground ground;
    ground.hear(1.0);
    ground.monitor.link("uhf_live", LinkIs::lost, "unexplained: nothing is predicted to silence it now", at_s(3.0),
                        ground.changes);
    CHECK(ground.after(3.5) == 0);
    REQUIRE(ground.after(4.0) == 1);  // not of now a second after nothing can come, though it is not due yet
    CHECK(ground.after(9.0) == 1);
    CHECK(ground.changes[0].is == Staleness::explained);
    CHECK(ground.changes[0].silent_s == 3.0);
    CHECK(ground.changes[0].reason == "the link is lost: unexplained: nothing is predicted to silence it now");
    REQUIRE(ground.after(9.5) == 2);  // four intervals after it was last heard, not after the link went
    CHECK(ground.changes[1].is == Staleness::missing);
    CHECK(ground.changes[1].silent_s == 8.5);
    CHECK(ground.changes[1].reason == ground.changes[0].reason);
    ground.monitor.link("uhf_live", LinkIs::up, "nominal", at_s(20.0), ground.changes);
    CHECK(ground.after(21.0) == 2);  // until it is heard
    ground.hear(22.0);
    REQUIRE(ground.after(30.0) == 3);
    CHECK(ground.changes[2].reason == "heard again");
    REQUIRE(ground.after(30.5) == 4);  // while the link is up
    CHECK(ground.changes[3].reason.empty());
    ground.monitor.link("uhf_live", LinkIs::lost, "ground fault: no way to the station", at_s(31.0), ground.changes);
    CHECK(ground.after(60.0) == 4);  // that stands
    ground.monitor.link("uhf_live", LinkIs::down, "Earth set", at_s(61.0), ground.changes);
    REQUIRE(ground.after(900.0) == 5);
    CHECK(ground.changes[4].is == Staleness::explained);
    CHECK(ground.changes[4].reason == "the link is down: Earth set");
}

TEST_CASE("what comes again over a link that was lost is current, and was no alarm before it was due",
          "[alarms][staleness]") {
    Ground ground;
    ground.hear(1.0);
    ground.monitor.link("uhf_live", LinkIs::lost, "unexplained", at_s(2.0), ground.changes);
    REQUIRE(ground.after(4.0) == 1);
    ground.monitor.link("uhf_live", LinkIs::up, "nominal", at_s(5.0), ground.changes);
    ground.hear(5.5);
    REQUIRE(ground.after(6.0) == 2);
    CHECK(ground.changes[0].is == Staleness::explained);
    CHECK(ground.changes[1].is == Staleness::current);
}

TEST_CASE("a silence that is not explained any more is waited for from then, with the usual patience",
          "[alarms][staleness]") {
    Ground ground;
    ground.hear(1.0);
    ground.monitor.link("uhf_live", LinkIs::down, "plasma blackout", at_s(3.0), ground.changes);
    CHECK(ground.after(79.0) == 1);  // explained
    ground.monitor.link("uhf_live", LinkIs::lost, "unexplained", at_s(80.0), ground.changes);
    CHECK(ground.after(88.0) == 1);
    SECTION("nothing comes: it is missing") {
        REQUIRE(ground.after(88.5) == 2);
        CHECK(ground.changes[1].is == Staleness::missing);
        CHECK(ground.changes[1].silent_s == 87.5);
    }
    SECTION("the link is there again: its packets have as long to come as after any silence") {
        ground.monitor.link("uhf_live", LinkIs::up, "nominal", at_s(88.0), ground.changes);
        CHECK(ground.after(96.0) == 1);
        CHECK(ground.after(96.5) == 2);
    }
    SECTION("another link is up: it brings them") {
        ground.monitor.link("uhf_mro", LinkIs::up, "nominal", at_s(88.0), ground.changes);
        CHECK(ground.after(96.0) == 1);
        REQUIRE(ground.after(96.5) == 2);
        CHECK(ground.changes[1].reason.empty());
    }
}

TEST_CASE("what is expected goes by the phase: less often in entry, not at all on the ground", "[alarms][staleness]") {
    Ground ground;
    ground.hear(1.0);
    ground.monitor.phase("range_control", at_s(2.0), ground.changes);
    CHECK(ground.after(18.0) == 0);
    CHECK(ground.after(18.5) == 1);
    ground.monitor.phase("landed", at_s(20.0), ground.changes);
    REQUIRE(ground.changes.size() == 2);
    CHECK(ground.changes[1].is == Staleness::explained);
    CHECK(ground.changes[1].reason == "not expected in landed");
    CHECK(ground.after(500.0) == 2);
}

TEST_CASE("a packet that the phase does not promise is stale five seconds after its last, and no alarm",
          "[alarms][staleness]") {
    Ground ground;
    ground.monitor.phase("landed", at_s(0.5), ground.changes);
    ground.hear(1.0);  // was under way
    CHECK(ground.after(6.0) == 0);
    REQUIRE(ground.after(6.1) == 1);
    CHECK(ground.changes[0].is == Staleness::explained);
    CHECK(ground.changes[0].reason == "not expected in landed");
}

TEST_CASE("a packet without a promise is stale once the links are lost, and no alarm", "[alarms][staleness]") {
    Ground ground;
    ground.monitor.heard(held, at_s(1.0), ground.changes);
    CHECK(ground.after(1000.0) == 0);  // it comes when something changes
    ground.monitor.link("uhf_live", LinkIs::lost, "unexplained", at_s(1001.0), ground.changes);
    REQUIRE(ground.after(1001.0) == 1);
    CHECK(ground.changes[0].is == Staleness::explained);
    CHECK(ground.changes[0].reason == "the link is lost: unexplained");
    ground.monitor.link("uhf_live", LinkIs::up, "nominal", at_s(1010.0), ground.changes);
    CHECK(ground.after(1100.0) == 1);
}

TEST_CASE("a packet that the ground makes is stale when it makes none, whatever the links do", "[staleness]") {
    Ground ground;
    ground.monitor.made_on_ground(status, at_s(1.0), ground.changes);
    ground.monitor.link("uhf_live", LinkIs::down, "plasma blackout", at_s(1.5), ground.changes);
    CHECK(ground.after(6.0) == 0);
    REQUIRE(ground.after(6.1) == 1);
    CHECK(ground.changes[0].is == Staleness::explained);
    CHECK(ground.changes[0].reason == "the ground makes none");
}

TEST_CASE("a packet without channels has no value that could be stale", "[staleness]") {
    Ground ground;
    for (auto& field : ground.dictionary.packets[held].fields) field.channel.reset();
    StalenessMonitor monitor{ground.dictionary};
    monitor.link("uhf_live", LinkIs::up, "nominal", at_s(0.0), ground.changes);
    monitor.heard(held, at_s(1.0), ground.changes);
    monitor.link("uhf_live", LinkIs::down, "plasma blackout", at_s(3.0), ground.changes);
    monitor.pass(at_s(100.0), ground.changes);
    CHECK(ground.changes.empty());
}

TEST_CASE("without a plan a packet without a rate is stale after four of the intervals at which it came lately",
          "[staleness][downlink]") {
    auto dictionary = Ground::make();
    dictionary.telemetry_plan.clear();
    StalenessMonitor monitor{dictionary};
    std::vector<StalenessChange> changes;
    monitor.link("downlink", LinkIs::up, "connected", at_s(0.0), changes);
    for (const double s : {1.0, 11.0, 21.0}) monitor.heard(held, at_s(s), changes);
    monitor.pass(at_s(61.0), changes);
    CHECK(changes.empty());
    monitor.pass(at_s(61.5), changes);
    REQUIRE(changes.size() == 1);
    CHECK(changes[0].is == Staleness::explained);  // nobody promised it
}

TEST_CASE("how long nothing may come before a value is old: by the slowest promise live, by each packet in a recording",
          "[staleness]") {
    auto dictionary = Ground::make();
    CHECK(stale_after_s(dictionary, status) == 16.0);                        // every 4th second in entry
    CHECK(stale_in_recording_after_s(dictionary, status) == stale_least_s);  // where each second has one
    CHECK_FALSE(stale_after_s(dictionary, held));
    dictionary.telemetry_plan.clear();
    CHECK(stale_after_s(dictionary, status) == stale_least_s);
}

TEST_CASE("what never came, has no rate, or is of a plan that may not be flown is not missed", "[alarms][staleness]") {
    Ground ground;
    CHECK(ground.after(100.0) == 0);
    ground.monitor.heard(held, at_s(100.0), ground.changes);
    CHECK(ground.after(1000.0) == 0);
    ground.dictionary.telemetry_plan[0].plan = "wideband";
    StalenessMonitor other{ground.dictionary};
    other.link("uhf_live", LinkIs::up, "nominal", at_s(0.0), ground.changes);
    other.phase("late_cruise", at_s(0.0), ground.changes);
    other.heard(status, at_s(1.0), ground.changes);
    other.pass(at_s(1000.0), ground.changes);
    CHECK(ground.changes.empty());
}

TEST_CASE("a mission without a plan is expected at the rates of its dictionary", "[alarms][staleness]") {
    auto dictionary = Ground::make();
    dictionary.telemetry_plan.clear();
    StalenessMonitor monitor{dictionary};
    std::vector<StalenessChange> changes;
    monitor.link("downlink", LinkIs::up, "connected", at_s(0.0), changes);
    monitor.heard(status, at_s(1.0), changes);
    monitor.pass(at_s(6.0), changes);
    CHECK(changes.empty());  // five seconds at least
    monitor.pass(at_s(6.5), changes);
    CHECK(changes.size() == 1);
}

TEST_CASE("a link that loses much explains a longer silence, and one that lost nothing does not",
          "[alarms][staleness]") {
    Ground lossy;
    Ground sound;
    // Every 2 s; of the lossy one each fourth is lost, as near the horizon: 25 %, so that 8.3 in a row are one in 1e5.
    for (int i = 0; i < 60; ++i) {
        if (i % 4 != 3) lossy.hear(2.0 * i);
        sound.hear(2.0 * i);
    }
    REQUIRE(lossy.changes.empty());
    CHECK(lossy.after(116.0 + 16.0) == 0);
    CHECK(lossy.after(116.0 + 17.5) == 1);
    CHECK(sound.after(118.0 + 8.0) == 0);
    CHECK(sound.after(118.0 + 8.5) == 1);
}

TEST_CASE("a packet that was stale tells nothing of the link's losses, and old losses are forgotten",
          "[alarms][staleness]") {
    Ground ground;
    ground.hear(1.0);
    REQUIRE(ground.after(40.0) == 1);
    ground.hear(41.0);  // twenty are missing, because it was not sent
    REQUIRE(ground.changes.size() == 2);
    CHECK(ground.after(49.5) == 3);  // as soon as ever
    ground.hear(50.0);
    ground.hear(57.0);  // 3.5 due, one came
    for (double s = 59.0; s < 600.0; s += 2.0) ground.hear(s);
    const auto before = ground.changes.size();
    CHECK(ground.after(599.0 + 8.5) == before + 1);
}

}  // namespace telemetry_staleness_test
