// SPDX-License-Identifier: Apache-2.0
#include "telemetry/touchdown.hpp"

#include "tests/support/catch.hpp"

#include <algorithm>
#include <cmath>

namespace telemetry_touchdown_test {

using namespace aeolis;
using namespace aeolis::telemetry;
using Step = TouchdownStep::State;

namespace {

constexpr double down_s = 1430.0, entry_s = 1000.0;

/// Told by the timepoint, with UHF and a rover at rest each second from the touchdown to `to_s`.
TouchdownFacts heard_until(double to_s) {
    TouchdownFacts facts;
    facts.entry = Sclk{entry_s};
    facts.now = Sclk{to_s};
    facts.told = {{Sclk{down_s}, "timepoint touchdown by UHF"}};
    facts.flag_name = "touchdown_declared";
    facts.live_name = "edl_phase";
    facts.rover_imu_known = true;
    for (double sclk_s = down_s - 5.0; sclk_s <= to_s; sclk_s += 1.0) {
        facts.live.push_back(Sclk{sclk_s});
        facts.rover_imu.push_back({Sclk{sclk_s}, 0.0007, still_weight_mps2});
    }
    return facts;
}

TouchdownStep still_step(const TouchdownFacts& facts) {
    return judge_touchdown(facts).steps.at(1);
}

}  // namespace

TEST_CASE("nothing is said of a touchdown that nothing has told of", "[touchdown][R53]") {
    auto facts = heard_until(down_s + 20.0);
    facts.told.clear();
    facts.flag = TouchdownFacts::Flag{Sclk{down_s}, 0.0};
    const auto report = judge_touchdown(facts);
    CHECK(report.verdict == TouchdownVerdict::untold);
    CHECK(report.steps.empty());
    CHECK(report.sclk == Sclk{});
}

TEST_CASE("a touchdown is confirmed once all three signals are there, and not a second before", "[touchdown]") {
    // The first samples after the touchdown are a second after it.
    CHECK(judge_touchdown(heard_until(down_s + 10.0)).verdict == TouchdownVerdict::reported);
    const auto report = judge_touchdown(heard_until(down_s + 11.0));
    CHECK(report.verdict == TouchdownVerdict::confirmed);
    REQUIRE(report.steps.size() == 3);
    for (const auto& step : report.steps) CHECK(step.state == Step::done);
    CHECK(report.steps.at(1).since->seconds == down_s + 11.0);
    CHECK(report.steps.at(1).words ==
          "E+7:21.0: still since E+7:11.0, now rover_imu_rate_rps 0.0007, rover_imu_force_mps2 3.71");
}

TEST_CASE("where nobody knows when entry was, a touchdown's times are those of the vehicle's clock", "[touchdown]") {
    auto facts = heard_until(down_s + 11.0);
    facts.entry = Sclk{};
    for (const auto& step : judge_touchdown(facts).steps) {
        CHECK_THAT(step.words, Catch::StartsWith("SCLK "));
        CHECK_THAT(step.words, !Catch::Contains("E+"));
    }
}

TEST_CASE("a touchdown of a mission without the rover's own IMU stays reported, however long UHF comes",
          "[touchdown]") {
    auto facts = heard_until(down_s + 60.0);
    facts.rover_imu_known = false;
    facts.rover_imu.clear();
    const auto report = judge_touchdown(facts);
    CHECK(report.verdict == TouchdownVerdict::reported);
    CHECK(report.steps.at(1).state == Step::never);
    CHECK(report.steps.at(2).state == Step::done);
}

TEST_CASE("a rover that moves by either measure begins the count of its rest anew", "[touchdown]") {
    CHECK(still_step(heard_until(down_s + 5.0)).words == "4 s of 10 s since E+7:11.0");
    const auto moved = [](double rate_rps, double force_mps2, double by_s) {
        auto facts = heard_until(down_s + 15.0);
        for (auto& told : facts.rover_imu)
            if (told.sclk.seconds == down_s + by_s) told = {told.sclk, rate_rps, force_mps2};
        return still_step(facts);
    };
    const double weight = still_weight_mps2, within = still_weight_within_mps2;
    CHECK(moved(still_rate_max_rps, weight, 5.0).state == Step::done);  // either bound is still
    CHECK(moved(0.0007, weight + 0.999 * within, 5.0).state == Step::done);
    CHECK(moved(1.001 * still_rate_max_rps, weight, 5.0).words == "9 s of 10 s since E+7:16.0");
    CHECK(moved(0.0007, weight + 1.001 * within, 5.0).words == "9 s of 10 s since E+7:16.0");
    CHECK(moved(0.0007, weight - 1.001 * within, 5.0).words == "9 s of 10 s since E+7:16.0");
    CHECK(moved(0.02, 3.9, 15.0).state == Step::done);  // it had been still for its time before
    auto swings = heard_until(down_s + 30.0);
    for (auto& told : swings.rover_imu) told.rate_rps = 0.0122 * std::abs(std::cos(0.7 * told.sclk.seconds));  // 1°
    CHECK(judge_touchdown(swings).verdict == TouchdownVerdict::reported);
    auto now = heard_until(down_s + 8.0);
    now.rover_imu.back() = {now.rover_imu.back().sclk, 0.02, 3.9};
    CHECK(still_step(now).state == Step::waiting);
    CHECK(still_step(now).words == "moves at E+7:18.0: rover_imu_rate_rps 0.0200, rover_imu_force_mps2 3.90; still is "
                                   "at most 0.005 rad/s and 3.71 ± 0.1 m/s2");
}

TEST_CASE("a rover's IMU that is silent leaves the touchdown reported, with the reason", "[touchdown]") {
    auto silent = heard_until(down_s + 30.0);
    silent.rover_imu.clear();
    CHECK(judge_touchdown(silent).verdict == TouchdownVerdict::reported);
    CHECK(still_step(silent).state == Step::unknown);
    CHECK(still_step(silent).words == "not known: rover_imu_rate_rps has told nothing since touchdown at E+7:10.0");
    silent.silences = {{Sclk{down_s + 2.0}, {}, "fault: the station is out"}};
    CHECK(still_step(silent).words == "not known: rover_imu_rate_rps has told nothing since touchdown at E+7:10.0: no "
                                      "UHF since E+7:12.0: fault: the station is out");
    auto stops = heard_until(down_s + 30.0);
    std::erase_if(stops.rover_imu, [](const auto& told) { return told.sclk.seconds > down_s + 5.0; });
    CHECK(still_step(stops).state == Step::unknown);
    CHECK(still_step(stops).words ==
          "not known: rover_imu_rate_rps has told nothing since E+7:15.0; it had been still for 4 s");
    auto gap = heard_until(down_s + 15.0);
    std::erase_if(gap.rover_imu, [](const auto& told) {
        return told.sclk.seconds > down_s + 4.0 && told.sclk.seconds < down_s + 8.0;
    });
    CHECK(still_step(gap).words == "7 s of 10 s since E+7:18.0");
}

TEST_CASE("all that tells of a touchdown is said, and it was when the first of it says", "[touchdown]") {
    auto facts = heard_until(down_s + 1.0);
    facts.told.push_back({Sclk{down_s - 0.5}, "event TOUCHDOWN by the recording"});
    const auto report = judge_touchdown(facts);
    CHECK(report.sclk.seconds == down_s - 0.5);
    CHECK(report.steps.at(0).words == "E+7:09.5: event TOUCHDOWN by the recording, timepoint touchdown by UHF");
}

TEST_CASE("a newer flag that says no contradicts a touchdown; one as old as the touchdown does not", "[touchdown]") {
    auto facts = heard_until(down_s + 20.0);
    facts.flag = TouchdownFacts::Flag{Sclk{down_s + touchdown_gap_s}, 0.0};
    CHECK(judge_touchdown(facts).verdict == TouchdownVerdict::confirmed);
    facts.flag->sclk = Sclk{down_s + touchdown_gap_s + 0.5};
    const auto report = judge_touchdown(facts);
    CHECK(report.verdict == TouchdownVerdict::contradicted);
    CHECK(report.steps.at(0).words ==
          "timepoint touchdown by UHF at E+7:10.0, but touchdown_declared is 0 at E+7:13.5");
}

TEST_CASE("UHF must come without a break: a gap or a silence begins the count anew", "[touchdown]") {
    const auto uhf = [](const TouchdownFacts& facts) { return judge_touchdown(facts).steps.at(2); };
    // The first sample after the touchdown is a second after it.
    CHECK(uhf(heard_until(down_s + 10.0)).state == Step::waiting);
    CHECK(uhf(heard_until(down_s + 10.0)).words == "9 s of 10 s since E+7:11.0");
    const auto done = uhf(heard_until(down_s + 11.0));
    CHECK(done.state == Step::done);
    CHECK(done.since->seconds == down_s + 11.0);

    auto gap = heard_until(down_s + 11.0);
    std::erase_if(gap.live, [](Sclk sclk) { return sclk.seconds > down_s + 4.0 && sclk.seconds < down_s + 8.0; });
    CHECK(uhf(gap).words == "3 s of 10 s since E+7:18.0");
    auto silent = heard_until(down_s + 11.0);
    silent.silences = {{Sclk{down_s + 4.2}, Sclk{down_s + 4.8}, "plasma blackout"}};
    CHECK(uhf(silent).words == "6 s of 10 s since E+7:15.0");
}

TEST_CASE("without UHF its step is not known, with the reason of the silence where there is one", "[touchdown]") {
    auto facts = heard_until(down_s - 1.0);
    facts.now = Sclk{down_s + 20.0};
    CHECK(judge_touchdown(facts).steps.at(2).words == "not known: no UHF since touchdown at E+7:10.0");
    facts.silences = {{Sclk{down_s - 1.0}, {}, "fault: the station is out"}};
    CHECK(judge_touchdown(facts).steps.at(2).words == "not known: no UHF since E+7:09.0: fault: the station is out");
    auto lost = heard_until(down_s + 5.0);
    lost.now = Sclk{down_s + 20.0};
    const auto step = judge_touchdown(lost).steps.at(2);
    CHECK(step.state == Step::unknown);
    CHECK(step.words == "not known: no UHF since E+7:15.0; 4 s had come without a break");
}

}  // namespace telemetry_touchdown_test
