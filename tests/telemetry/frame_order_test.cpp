// SPDX-License-Identifier: Apache-2.0
#include "telemetry/frame_order.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

#include <set>

namespace telemetry_frame_order_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

/// A channel whose frames hold their own number.
struct Channel {
    explicit Channel(std::uint32_t its_modulus) : modulus(its_modulus) {}
    FrameOrder::Placed place(std::uint64_t number, std::uint8_t content = 0) {
        const std::array<std::uint8_t, 3> octets{static_cast<std::uint8_t>(number),
                                                 static_cast<std::uint8_t>(number >> 8U), content};
        return order.place(static_cast<std::uint32_t>(number % modulus), modulus, octets, counters);
    }
    std::uint32_t modulus;
    FrameOrder order;
    SequenceCounters counters;
};

}  // namespace

TEST_CASE("frames that follow each other leave no gap, also where the count wraps", "[telemetry][R55]") {
    for (const std::uint32_t modulus : {256U, 1U << 24U}) {
        Channel channel{modulus};
        for (std::uint64_t i = 4ULL * modulus - 300; i < 4ULL * modulus + 300; ++i)
            CHECK(channel.place(i).place == FramePlace::next);
        CHECK(channel.counters == SequenceCounters{.received = 600, .wraps = modulus == 256U ? 3U : 1U});
    }
}

TEST_CASE("missing frames are counted, and one that comes late is not missing any more", "[telemetry][R55]") {
    Channel channel{1U << 24U};
    channel.place(1000);
    const auto gap = channel.place(1004);
    CHECK(gap.place == FramePlace::after_gap);
    CHECK(gap.missing == 3);
    CHECK(channel.place(1002).place == FramePlace::late);
    CHECK(channel.place(1002).place == FramePlace::repeated);
    CHECK(channel.place(1005).place == FramePlace::next);
    CHECK(channel.counters == SequenceCounters{.received = 5, .gaps = 1, .missing = 2, .repeated = 1, .late = 1});
    CHECK(channel.place(999).place == FramePlace::late);  // before the first one: nobody missed it
    CHECK(channel.counters.missing == 2);
}

TEST_CASE("a count that begins anew is a restart and not millions of missing frames", "[telemetry][R55]") {
    Channel channel{1U << 24U};
    for (std::uint64_t i = 9'000'000; i < 9'000'100; ++i) channel.place(i);
    CHECK(channel.place(0).place == FramePlace::restarted);
    for (std::uint64_t i = 1; i < 20; ++i) CHECK(channel.place(i).place == FramePlace::next);
    CHECK(channel.place(0, 1).place == FramePlace::restarted);  // known from its content alone
    CHECK(channel.place(1, 1).place == FramePlace::next);
    CHECK(channel.counters == SequenceCounters{.received = 122, .restarts = 2});
}

TEST_CASE("one late packet is one late packet: its count of 14 bits wraps, too", "[telemetry][R54]") {
    Channel channel{1U << 14U};
    for (std::uint64_t i = 16'300; i < 16'410; ++i)
        if (i != 16'383) channel.place(i);
    CHECK(channel.place(16'383).place == FramePlace::late);
    CHECK(channel.place(16'410).place == FramePlace::next);
    CHECK(channel.counters == SequenceCounters{.received = 111, .gaps = 1, .late = 1, .wraps = 1});
}

TEST_CASE(
    "whatever is lost, repeated and late, each frame is given a place once, and the counters come to what was sent",
    "[telemetry][R55][property]") {
    for (unsigned seed = 0; seed < 200; ++seed) {
        CAPTURE(seed);
        std::mt19937 random{seed};
        Channel channel{seed % 2 == 0 ? 256U : 1U << 24U};
        std::set<std::uint64_t> given;
        std::vector<std::uint64_t> delayed;
        std::uint64_t lost = 0, repeated = 0;
        const auto put = [&](std::uint64_t number) {
            const auto place = channel.place(number).place;
            REQUIRE(place != FramePlace::restarted);
            REQUIRE((place == FramePlace::repeated) == given.contains(number));
            given.insert(number);
        };
        for (std::uint64_t i = 0; i < 2000; ++i) {
            const auto what = i < 3 || i > 1960 ? 9 : random() % 10;
            if (what == 0) {
                ++lost;
            } else if (what == 1) {
                delayed.push_back(i);
            } else {
                put(i);
                if (what == 2) {
                    put(i);
                    ++repeated;
                }
            }
            if (!delayed.empty() && (delayed.front() + 20 < i || random() % 4 == 0) && delayed.front() < i) {
                put(delayed.front());
                delayed.erase(delayed.begin());
            }
        }
        for (const auto number : delayed) put(number);
        CHECK(channel.counters.missing == lost);
        CHECK(channel.counters.repeated == repeated);
        CHECK(given.size() + lost == 2000);
    }
}

}  // namespace telemetry_frame_order_test
