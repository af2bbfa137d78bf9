// SPDX-License-Identifier: Apache-2.0
#include "telemetry/packet_stream.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/small_dictionary.hpp"

#include <random>

namespace telemetry_packet_stream_test {

using namespace aeolis;
using aeolis::telemetry::PacketStream;
using aeolis::tests::PacketFiller;

namespace {

std::vector<std::uint8_t> three_packets(std::size_t& first_two) {
    const auto dictionary = tests::small_dictionary();
    std::vector<std::uint8_t> octets;
    for (const char* name : {"Status", "COMMAND_ACCEPTED", "Explanation"}) {
        if (octets.size() > 40) first_two = octets.size();
        const auto packet = PacketFiller{dictionary, name}.seal();
        octets.insert(octets.end(), packet.begin(), packet.end());
    }
    return octets;
}

}  // namespace

TEST_CASE("packets one after another come out one by one", "[packet_stream]") {
    std::size_t first_two = 0;
    const auto octets = three_packets(first_two);
    PacketStream stream{octets};
    std::size_t sum = 0;
    while (const auto packet = stream.next()) sum += packet->size();
    CHECK(stream.packets() == 3);
    CHECK(sum == octets.size());
    CHECK(stream.unreadable_octets() == 0);
}

TEST_CASE("a packet that is cut off is counted, not given", "[packet_stream]") {
    std::size_t first_two = 0;
    const auto octets = three_packets(first_two);
    PacketStream stream{std::span{octets}.first(octets.size() - 1)};
    while (stream.next()) {
    }
    CHECK(stream.packets() == 2);
    CHECK(stream.unreadable_octets() == octets.size() - 1 - first_two);
}

TEST_CASE("whatever the octets are, each is in a packet or counted as unreadable", "[packet_stream][property]") {
    std::mt19937 random{1971};
    for (int round = 0; round < 20'000; ++round) {
        std::vector<std::uint8_t> octets(random() % 300);
        for (auto& octet : octets) octet = static_cast<std::uint8_t>(random());
        // Headers that can be read, with short lengths.
        if (octets.size() > 5 && round % 2 == 0) {
            octets[0] &= 0x1F;
            octets[2] |= 0xC0;
            octets[4] = 0;
        }
        PacketStream stream{octets};
        std::size_t sum = 0;
        while (const auto packet = stream.next()) sum += packet->size();
        REQUIRE(sum + stream.unreadable_octets() == octets.size());
    }
}

}  // namespace telemetry_packet_stream_test
