// SPDX-License-Identifier: Apache-2.0
#include "telemetry/packet_clocks.hpp"
#include "tests/support/catch.hpp"

namespace telemetry_packet_clocks_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

Ert at_s(double seconds) {
    return Ert{static_cast<std::int64_t>(seconds * 1e6)};
}
/// The remarks on a clock that shows these times, a second apart on Earth.
std::vector<std::string> remarks_on(const std::vector<double>& times_s) {
    PacketClocks clocks{1};
    std::vector<std::string> remarks;
    double ert_s = 0.0;
    for (const double time_s : times_s) {
        const auto place = clocks.place(0, "P", Sclk{time_s}, at_s(ert_s += 1.0));
        CHECK(place.sclk.seconds == time_s);
        CHECK_FALSE(place.by_reception);
        if (place.remark) remarks.push_back(*place.remark);
    }
    return remarks;
}

}  // namespace

TEST_CASE("a packet without a time stands at its reception, on the axis of those that have one, and it is said once",
          "[telemetry][downlink][R54]") {
    PacketClocks clocks{3};
    const auto alone = clocks.place(2, "Bare", {}, at_s(700.0));
    CHECK(alone.by_reception);
    CHECK(alone.sclk.seconds == 700.0);
    CHECK(alone.remark == "packet Bare holds no time: its samples stand at their reception");
    CHECK(clocks.place(0, "Timed", Sclk{5000.0}, at_s(800.0)).sclk.seconds == 5000.0);
    CHECK(clocks.place(1, "Other", Sclk{12.0}, at_s(801.0)).sclk.seconds == 12.0);
    const auto later = clocks.place(2, "Bare", {}, at_s(802.5));
    CHECK(later.sclk.seconds == 5002.5);  // by the first type that had a time, whatever others show
    CHECK_FALSE(later.remark);
}

TEST_CASE("a clock that restarts, jumps or stands still is told; one that goes on, by any step, is not",
          "[telemetry][downlink][R54]") {
    CHECK(remarks_on({1, 2, 3, 3, 4, 14, 15, 16, 17, 18, 19}).empty());
    CHECK(remarks_on({5010, 5011, 0, 1, 2}) ==
          std::vector<std::string>{
              "the clock of packet P went back from 5011 s to 0 s: what follows stands at the new times"});
    // One late packet is no restart.
    CHECK(remarks_on({10, 11, 13, 12, 14, 15}).empty());
    CHECK(remarks_on({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 5000, 5001}) ==
          std::vector<std::string>{"the clock of packet P jumped from 10 s to 5000 s"});
    std::vector<double> still{1, 2, 3};
    still.resize(100, 4.0);
    CHECK(remarks_on(still) == std::vector<std::string>{"the clock of packet P stands still at 4 s"});
    CHECK(remarks_on(std::vector<double>(100, 4.0)).empty());  // it never went: a constant, not a clock that stopped
}

TEST_CASE("a clock that does so all the time is told of ten times", "[telemetry][downlink]") {
    std::vector<double> times_s;
    for (int i = 0; i < 100; ++i) times_s.insert(times_s.end(), {5000.0, 5001.0, 0.0, 1.0});
    CHECK(remarks_on(times_s).size() == PacketClocks::remarks_max);
}

}  // namespace telemetry_packet_clocks_test
