// SPDX-License-Identifier: Apache-2.0
#include "server/base/clock_watch.hpp"
#include "tests/support/catch.hpp"

#include <random>
#include <vector>

namespace server_clock_watch_test {

using namespace aeolis;
using namespace aeolis::server;

namespace {

constexpr std::int64_t second_us = 1'000'000;

/// Clocks that a test moves.
struct Clocks {
    ClockReading reading{1'344'230'000 * second_us, 77 * second_us, 2};
    ReadClocks read() {
        return [this] { return reading; };
    }
    void pass(std::int64_t us) {
        reading.system_us += us;
        reading.monotonic_us += us;
    }
};

}  // namespace

TEST_CASE("a jump of the system's clock is told once, with its size and both times", "[clock][R62]") {
    Clocks clocks;
    ClockWatch watch{clocks.read()};
    clocks.pass(second_us);
    CHECK_FALSE(watch.look());
    clocks.reading.system_us -= 3600 * second_us;
    const auto jump = watch.look();
    REQUIRE(jump);
    CHECK(jump->by_us == -3600 * second_us);
    CHECK(text_of(*jump) == "the system's clock jumped 3600.000 s back, from 2012-08-06T05:13:21Z to "
                            "2012-08-06T04:13:21Z: it was set, or the machine slept");
    clocks.pass(second_us);
    CHECK_FALSE(watch.look());
    clocks.reading.system_us += 1800 * second_us;
    CHECK_THAT(text_of(*watch.look()), Catch::Contains("1800.000 s forward"));
    CHECK(watch.jumps() == 2);
    CHECK(watch.moved_s() == -1800.0);
}

TEST_CASE("a step below the least jump is told when further steps have made it one", "[clock][R62]") {
    Clocks clocks;
    ClockWatch watch{clocks.read()};
    clocks.reading.system_us += ClockWatch::least_us - 1;
    CHECK_FALSE(watch.look());
    clocks.reading.system_us += 1;
    CHECK(watch.look()->by_us == ClockWatch::least_us);
}

TEST_CASE("a reading that was interrupted shows no jump", "[clock][R62]") {
    Clocks clocks;
    ClockWatch watch{clocks.read()};
    clocks.reading.system_us += second_us;
    clocks.reading.taken_us = ClockWatch::blurred_us + 1;
    CHECK_FALSE(watch.look());
    clocks.reading.taken_us = 1;
    CHECK(watch.look());
}

TEST_CASE("over random jumps the time on Earth counts true seconds and never goes back, and the jumps told add up to "
          "what the clock was moved",
          "[clock][R62]") {
    std::mt19937_64 random{26};
    for (int round = 0; round < 200; ++round) {
        Clocks clocks;
        const auto begun = clocks.reading;
        ClockWatch watch{clocks.read()};
        const EarthClock earth{clocks.read()};
        const auto first = earth.now();
        std::int64_t told_us = 0, moved_us = 0;
        Ert last = first;
        for (int step = 0; step < 100; ++step) {
            clocks.pass(static_cast<std::int64_t>(random() % (3 * second_us)));
            if (random() % 4 == 0) {
                const auto by_us =
                    static_cast<std::int64_t>(random() % (2'000'000 * second_us)) - 1'000'000 * second_us;
                const auto small_us = by_us % (2 * ClockWatch::least_us);
                moved_us += random() % 2 == 0 ? by_us : small_us;
                clocks.reading.system_us =
                    begun.system_us + moved_us + clocks.reading.monotonic_us - begun.monotonic_us;
            }
            if (const auto jump = watch.look()) told_us += jump->by_us;
            const auto now = earth.now();
            CHECK(now >= last);
            CHECK(now.microseconds - first.microseconds == clocks.reading.monotonic_us - begun.monotonic_us);
            CHECK(std::abs(moved_us - told_us) < ClockWatch::least_us);
            last = now;
        }
    }
}

TEST_CASE("the machine's own clocks do not jump by being read", "[clock]") {
    ClockWatch watch;
    const EarthClock earth;
    Ert last = earth.now();
    for (int i = 0; i < 1000; ++i) {
        CHECK(earth.now() >= last);
        last = earth.now();
    }
    CHECK(watch.jumps() == 0);
}

}  // namespace server_clock_watch_test
