// SPDX-License-Identifier: Apache-2.0
#include "flight/edl_comm/realtime_queue.hpp"

#include "tests/support/catch.hpp"

#include <array>
#include <deque>
#include <random>

namespace flight_realtime_queue_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

/// A packet that can be told from every other.
TelemetryPacket numbered(std::uint32_t number, std::uint16_t size = 20) {
    TelemetryPacket made;
    made.size = size;
    for (unsigned i = 0; i < 4; ++i) made.octets[i] = static_cast<std::uint8_t>(number >> (8 * i));
    return made;
}
std::uint32_t number_of(const TelemetryPacket& packet) {
    std::uint32_t number = 0;
    for (unsigned i = 0; i < 4; ++i) number |= std::uint32_t{packet.octets[i]} << (8 * i);
    return number;
}

}  // namespace

TEST_CASE("the most important packet goes first, of equals the oldest", "[realtime_queue][R30]") {
    RealtimeQueue queue;
    CHECK(queue.offer(numbered(1), TelemetryPriority::low));
    CHECK(queue.offer(numbered(2), TelemetryPriority::high));
    CHECK(queue.offer(numbered(3), TelemetryPriority::first));
    CHECK(queue.offer(numbered(4), TelemetryPriority::high));
    CHECK(queue.waiting_octets() == 80);
    CHECK(queue.waiting_octets(TelemetryPriority::high) == 40);
    for (const std::uint32_t next : {3U, 2U, 4U, 1U}) {
        CHECK(number_of(queue.front()) == next);
        queue.pop();
    }
    CHECK(queue.empty());
    CHECK(queue.waiting_octets() == 0);
}

TEST_CASE("a full queue gives up the least important, of equals the oldest", "[realtime_queue][R30]") {
    RealtimeQueue queue;
    for (std::uint32_t i = 0; i < RealtimeQueue::packets_max; ++i)
        CHECK(queue.offer(numbered(i), i < 2 ? TelemetryPriority::low : TelemetryPriority::normal));
    CHECK_FALSE(queue.offer(numbered(1000), TelemetryPriority::normal));  // packet 0 gives way
    CHECK_FALSE(queue.offer(numbered(1001), TelemetryPriority::low));     // packet 1 does, not the newcomer
    CHECK_FALSE(queue.offer(numbered(1002), TelemetryPriority::first));   // and then 1001
    CHECK(queue.dropped(TelemetryPriority::low) == 3);
    CHECK_FALSE(queue.offer(numbered(1003), TelemetryPriority::low));  // all that wait are more important
    CHECK(queue.dropped(TelemetryPriority::low) == 4);
    CHECK(queue.dropped() == 4);
    CHECK(queue.waiting() == RealtimeQueue::packets_max);
    CHECK(number_of(queue.front()) == 1002);
    queue.pop();
    CHECK(number_of(queue.front()) == 2);
}

TEST_CASE("under any load the queue does what its rule says, and its counts add up", "[realtime_queue][R30]") {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        std::mt19937 random{seed};
        RealtimeQueue queue;
        std::array<std::deque<std::uint32_t>, telemetry_priorities> wanted;  // the rule, written out at length
        std::array<std::uint32_t, telemetry_priorities> dropped{};
        std::uint32_t offered = 0;
        std::uint32_t sent = 0;
        const auto waiting = [&] { return wanted[0].size() + wanted[1].size() + wanted[2].size() + wanted[3].size(); };
        const unsigned load = 1 + seed % 4;  // offers for each packet sent
        for (int step = 0; step < 3000; ++step) {
            if (random() % (load + 1) != 0) {
                const std::size_t priority = random() % telemetry_priorities;
                queue.offer(numbered(offered), static_cast<TelemetryPriority>(priority));
                wanted[priority].push_back(offered++);
                if (waiting() > RealtimeQueue::packets_max) {
                    std::size_t least = 0;
                    while (wanted[least].empty()) ++least;
                    wanted[least].pop_front();
                    ++dropped[least];
                }
            } else if (!queue.empty()) {
                std::size_t most = telemetry_priorities - 1;
                while (wanted[most].empty()) --most;
                REQUIRE(number_of(queue.front()) == wanted[most].front());
                wanted[most].pop_front();
                queue.pop();
                ++sent;
            }
            REQUIRE(queue.waiting() == waiting());
        }
        for (std::size_t priority = 0; priority < telemetry_priorities; ++priority)
            CHECK(queue.dropped(static_cast<TelemetryPriority>(priority)) == dropped[priority]);
        CHECK(offered == sent + queue.dropped() + queue.waiting());
    }
}

}  // namespace flight_realtime_queue_test
