// SPDX-License-Identifier: Apache-2.0
#include "common/space_packet.hpp"
#include "tests/support/catch.hpp"

#include <array>
#include <random>
#include <vector>

namespace common_space_packet_test {

using namespace aeolis;

TEST_CASE("a telemetry packet reads back with its APID, count and exact time", "[common]") {
    std::vector<std::uint8_t> packet(tm_overhead_octets + 3, 0xAB);
    seal_tm_packet(packet, Apid{0x123}, 0x3FFF, Sclk{397501174.984375}, 77);
    const auto header = read_tm_packet(packet);
    REQUIRE(header);
    CHECK(header->primary.apid == Apid{0x123});
    CHECK(header->primary.count == 0x3FFF);
    CHECK(header->time.seconds == 397501174.984375);
    CHECK(header->dictionary_id == 77);
    CHECK(packet[tm_data_offset_octets] == 0xAB);
}

TEST_CASE("a primary header has the bits of the standard", "[common]") {
    std::vector<std::uint8_t> packet(tm_overhead_octets);
    seal_tm_packet(packet, Apid{0x7FE}, 1, Sclk{0.0}, 0);
    CHECK(packet[0] == 0x0F);
    CHECK(packet[1] == 0xFE);
    CHECK(packet[2] == 0xC0);
    CHECK(packet[3] == 0x01);
    CHECK(packet[5] == tm_overhead_octets - primary_header_octets - 1);
}

TEST_CASE("a telecommand packet gives back opcode and arguments", "[common]") {
    std::vector<std::uint8_t> packet(tc_overhead_octets + 2);
    packet[tc_arguments_offset_octets] = 0x12;
    packet[tc_arguments_offset_octets + 1] = 0x34;
    seal_tc_packet(packet, Apid{1}, 5, Opcode{0x0103});
    const auto command = read_tc_packet(packet);
    REQUIRE(command);
    CHECK(command->opcode == Opcode{0x0103});
    CHECK(command->primary.count == 5);
    REQUIRE(command->arguments.size() == 2);
    CHECK(command->arguments[1] == 0x34);
    CHECK_FALSE(read_tm_packet(packet));
}

TEST_CASE("every one-bit error in a packet is found", "[common]") {
    std::vector<std::uint8_t> packet(tm_overhead_octets + 8, 0x5A);
    seal_tm_packet(packet, Apid{0x20}, 9, Sclk{1.5}, 3);
    for (std::size_t bit = 0; bit < packet.size() * 8; ++bit) {
        auto damaged = packet;
        damaged[bit / 8] = static_cast<std::uint8_t>(damaged[bit / 8] ^ (1U << (bit % 8)));
        REQUIRE_FALSE(read_tm_packet(damaged));
    }
}

TEST_CASE("the length of any mission's packet is in its header, segmented or not", "[common]") {
    const std::array<std::uint8_t, 6> first_segment{0x0D, 0x91, 0x40, 0x00, 0x01, 0x29};
    CHECK(space_packet_octets(first_segment) == 6 + 0x129 + 1);
    CHECK_FALSE(space_packet_octets(std::span{first_segment}.first(5)));
    const std::array<std::uint8_t, 6> other_version{0xED, 0x91, 0x40, 0x00, 0xFF, 0xFF};
    CHECK_FALSE(space_packet_octets(other_version));
    const std::array<std::uint8_t, 6> longest{0x0D, 0x91, 0x40, 0x00, 0xFF, 0xFF};
    CHECK(space_packet_octets(longest) == space_packet_octets_max);
}

TEST_CASE("any octets at all are read as a packet or as none", "[common]") {
    std::mt19937 random{7};
    for (int round = 0; round < 20000; ++round) {
        std::vector<std::uint8_t> octets(random() % 40);
        for (auto& octet : octets) octet = static_cast<std::uint8_t>(random());
        (void)read_primary_header(octets);
        (void)read_tm_packet(octets);
        (void)read_tc_packet(octets);
    }
    SUCCEED();
}

}  // namespace common_space_packet_test
