// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/condition_watch.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <cmath>
#include <random>

namespace server_procedures_condition_watch_test {

using namespace aeolis;
using namespace aeolis::server::procedures;

namespace {

constexpr Ert at(double seconds) {
    return {static_cast<std::int64_t>(seconds * 1.0e6)};
}

ChannelId channel(const char* name) {
    return tests::shipped_dictionary().channel(name)->id;
}

/// One condition on altitude_m, watched.
struct AltitudeBelow {
    ConditionWatch watch{tests::shipped_dictionary()};
    std::size_t number;

    explicit AltitudeBelow(double value, double for_s = 0.0)
        : number(watch.add(ChannelCondition{channel("altitude_m"), Comparison::less, value, for_s})) {}
    ConditionState state() const { return watch.judge(number, {}); }
    Verdict verdict() const { return state().verdict; }
    void hear(std::optional<double> value, double seconds) {
        watch.on(ChannelSample{channel("altitude_m"), value, at(seconds)});
    }
};

}  // namespace

TEST_CASE("a channel that was never heard, is undefined on board or is stale is not known", "[procedures]") {
    AltitudeBelow low{5000.0};
    CHECK(low.state() == ConditionState{Verdict::not_known, "altitude_m was never received"});
    low.hear(std::nullopt, 10.0);
    CHECK(low.state() ==
          ConditionState{Verdict::not_known, "altitude_m is undefined on board, received 2000-001T12:00:10.000"});
    low.hear(4987.25, 11.0);
    CHECK(low.state() == ConditionState{Verdict::holds, "altitude_m is 4987.25 m, received 2000-001T12:00:11.000"});
    low.watch.pass(at(41.0));
    CHECK(low.verdict() == Verdict::holds);  // exactly 30 s old
    low.watch.pass(at(41.5));
    CHECK(low.state() ==
          ConditionState{Verdict::not_known, "altitude_m was last received 2000-001T12:00:11.000, 30 s ago"});
    low.hear(5000.0, 50.0);
    CHECK(low.state() ==
          ConditionState{Verdict::does_not_hold, "altitude_m is 5000 m, received 2000-001T12:00:50.000"});
}

TEST_CASE("for 3 s holds from receipt to receipt, and a gap or one other value begins it anew", "[procedures]") {
    AltitudeBelow low{5000.0, 3.0};
    low.hear(4000.0, 100.0);
    low.watch.pass(at(110.0));
    CHECK(low.verdict() == Verdict::does_not_hold);  // nothing was heard for 3 s, but once
    low.hear(4000.0, 102.9);
    CHECK(low.verdict() == Verdict::does_not_hold);
    low.hear(4000.0, 103.0);
    CHECK(low.state() ==
          ConditionState{Verdict::holds, "altitude_m is 4000 m, received 2000-001T12:01:43.000, so for 3 s"});
    low.hear(6000.0, 104.0);
    low.hear(4000.0, 105.0);
    CHECK(low.verdict() == Verdict::does_not_hold);
    low.hear(4000.0, 108.0);
    CHECK(low.verdict() == Verdict::holds);
    low.hear(4000.0, 138.5);  // 30.5 s of silence before
    CHECK(low.verdict() == Verdict::does_not_hold);
    low.hear(std::nullopt, 141.0);
    low.hear(4000.0, 142.0);
    CHECK(low.verdict() == Verdict::does_not_hold);
}

TEST_CASE("a value received before is not known where only what comes since counts", "[procedures]") {
    AltitudeBelow low{5000.0, 3.0};
    low.hear(4000.0, 100.0);
    low.hear(4000.0, 110.0);
    CHECK(low.watch.judge(low.number, at(110.0)).verdict == Verdict::does_not_hold);
    CHECK(low.watch.judge(low.number, at(111.0)) ==
          ConditionState{Verdict::not_known, "altitude_m was last received 2000-001T12:01:50.000, before that"});
    low.hear(4000.0, 113.0);
    CHECK(low.watch.judge(low.number, at(111.0)).verdict == Verdict::does_not_hold);
    low.hear(4000.0, 114.0);
    CHECK(low.watch.judge(low.number, at(111.0)).verdict == Verdict::holds);
}

TEST_CASE("an event counts by its receipt, from where it is said to count", "[procedures]") {
    const auto& dictionary = tests::shipped_dictionary();
    ConditionWatch watch{dictionary};
    const auto begun = watch.add(EventCondition{dictionary.event("EDL_BEGUN")->id, Since::run});
    CHECK(watch.judge(begun, {}) == ConditionState{Verdict::does_not_hold, "EDL_BEGUN was never received"});
    CHECK_FALSE(watch.on(EventReceived{dictionary.event("TOUCHDOWN")->id, at(1.0)}));
    CHECK(watch.on(EventReceived{dictionary.event("EDL_BEGUN")->id, at(2.0)}));
    CHECK(watch.judge(begun, {}).verdict == Verdict::holds);
    CHECK(watch.judge(begun, at(2.0)).verdict == Verdict::holds);
    CHECK(watch.judge(begun, at(2.5)) ==
          ConditionState{Verdict::does_not_hold, "EDL_BEGUN was last received 2000-001T12:00:02.000, before that"});
}

TEST_CASE("a time from entry is an instant on Earth's clock, with the light time where it is sent or received",
          "[procedures]") {
    ConditionWatch watch{tests::shipped_dictionary()};
    const auto sent = watch.add(TimeCondition{{-2820.0, EntryTime::Where::sent}});
    CHECK(watch.judge(sent, {}) == ConditionState{Verdict::not_known, "the time of entry is not known"});
    const EntryPrediction prediction{{10'000'000'000}, 828.0};
    watch.predict(prediction);
    CHECK(instant_of({-2820.0, EntryTime::Where::vehicle}, prediction) == at(7180.0));
    CHECK(instant_of({-2820.0, EntryTime::Where::sent}, prediction) == at(6352.0));
    CHECK(instant_of({-2820.0, EntryTime::Where::received}, prediction) == at(8008.0));
    watch.pass(at(6351.999));
    CHECK(watch.judge(sent, {}).verdict == Verdict::does_not_hold);
    watch.pass(at(6352.0));
    CHECK(watch.judge(sent, {}) == ConditionState{Verdict::holds, "E−47:00 sent is 2000-001T13:45:52.000"});
    watch.pass(at(1.0));  // the clock does not go back
    CHECK(watch.judge(sent, {}).verdict == Verdict::holds);
}

TEST_CASE("verdicts are those of a slow judge that keeps every sample, 300 runs from a seed", "[procedures]") {
    std::mt19937 random{30};
    std::array<std::size_t, 3> told{};
    for (int trial = 0; trial < 300; ++trial) {
        const double for_s = static_cast<double>(random() % 3) * 2.0;
        AltitudeBelow low{5000.0, for_s};
        std::vector<std::pair<double, std::optional<double>>> samples;
        double now = 0.0;
        for (int i = 0; i < 40; ++i) {
            now += static_cast<double>(random() % 5 == 0 ? random() % 50 : random() % 3) + 0.25;
            if (random() % 4 == 0) {
                low.watch.pass(at(now));
            } else {
                const auto value =
                    random() % 10 == 0 ? std::nullopt : std::optional{random() % 4 == 0 ? 6000.0 : 4000.0};
                samples.emplace_back(now, value);
                low.hear(value, now);
            }
            Verdict expected = Verdict::not_known;
            if (!samples.empty() && now - samples.back().first <= 30.0 && samples.back().second) {
                double since = samples.back().first;
                bool all = true;
                for (std::size_t k = samples.size(); k-- > 0 && all;) {
                    all = samples[k].second && *samples[k].second < 5000.0 && since - samples[k].first <= 30.0;
                    if (all) since = samples[k].first;
                }
                const bool below = *samples.back().second < 5000.0;
                expected = below && samples.back().first - since >= for_s ? Verdict::holds : Verdict::does_not_hold;
            }
            INFO("trial " << trial << ", step " << i);
            REQUIRE(low.verdict() == expected);
            ++told[static_cast<std::size_t>(expected)];
        }
    }
    for (const std::size_t times : told) CHECK(times > 500);
}

}  // namespace server_procedures_condition_watch_test
