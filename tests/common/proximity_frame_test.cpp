// SPDX-License-Identifier: Apache-2.0
#include "common/proximity_frame.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

namespace common_proximity_frame_test {

using namespace aeolis;

TEST_CASE("a PLTU has the bits of the standard", "[common]") {
    // Put together by hand from the field table; its CRC by an independent program.
    const auto known = test::hex("faf320 a04c101405 08a1c009000900000000000000000000 692bb3ef");
    const auto frame = read_pltu(known);
    REQUIRE(frame);
    CHECK(frame->header == ProximityHeader{.spacecraft = 76, .port = 1, .sequence = 5});
    CHECK(frame->data.size() == 16);
    std::vector<std::uint8_t> written(pltu_octets_max);
    written.resize(write_pltu(frame->header, frame->data, written));
    CHECK(written == known);
}

TEST_CASE("every header and length of a proximity frame reads back", "[common]") {
    std::mt19937 random{1};
    std::vector<std::uint8_t> pltu(pltu_octets_max);
    for (int round = 0; round < 2000; ++round) {
        const auto data = test::random_octets(random, 1 + random() % proximity_data_octets_max);
        const ProximityHeader header{random() % 2 == 0,
                                     random() % 2 == 0,
                                     static_cast<Construction>(random() % 4),
                                     static_cast<std::uint16_t>(random() % 1024),
                                     static_cast<std::uint8_t>(random() % 2),
                                     static_cast<std::uint8_t>(random() % 8),
                                     random() % 2 == 0,
                                     static_cast<std::uint8_t>(random())};
        const std::size_t size = write_pltu(header, data, pltu);
        REQUIRE(size == data.size() + pltu_overhead_octets);
        const auto frame = read_pltu(std::span{pltu}.first(size));
        REQUIRE(frame);
        REQUIRE(frame->header == header);
        REQUIRE(test::copy_of(frame->data) == data);
    }
}

TEST_CASE("a PLTU that is cut, longer, without its marker or with one bit wrong is refused with the reason",
          "[common]") {
    std::vector<std::uint8_t> pltu(pltu_octets_max);
    std::mt19937 random{2};
    pltu.resize(write_pltu({.spacecraft = 76}, test::random_octets(random, 40), pltu));
    for (std::size_t size = 0; size < pltu.size(); ++size)
        CHECK(read_pltu(std::span{pltu}.first(size)).why() == Malformed::too_short);
    auto longer = pltu;
    longer.push_back(0);
    CHECK(read_pltu(longer).why() == Malformed::too_long);
    for (std::size_t bit = 0; bit < pltu.size() * 8; ++bit) {
        auto damaged = pltu;
        damaged[bit / 8] = static_cast<std::uint8_t>(damaged[bit / 8] ^ (1U << (bit % 8)));
        const auto frame = read_pltu(damaged);
        REQUIRE_FALSE(frame);
        if (bit < 24) CHECK(frame.why() == Malformed::no_start);
        if (bit >= 64) CHECK(frame.why() == Malformed::bad_checksum);
    }
}

TEST_CASE("the length of a proximity frame is known from its header alone, or why not", "[common]") {
    CHECK(*proximity_frame_octets(test::hex("a04c101405")) == 21);
    CHECK(proximity_frame_octets(test::hex("a04c1014")).why() == Malformed::too_short);
    CHECK(proximity_frame_octets(test::hex("e04c101405")).why() == Malformed::other_version);
    CHECK(proximity_frame_octets(test::hex("a04c100405")).why() == Malformed::bad_field);
    CHECK(*proximity_frame_octets(test::hex("a04c17ff05")) == proximity_frame_octets_max);
}

TEST_CASE("a segment header says first, last and of which packet", "[common]") {
    for (unsigned octet = 0; octet < 256; ++octet)
        CHECK(segment_header_octet(read_segment_header(static_cast<std::uint8_t>(octet))) == octet);
    CHECK(read_segment_header(0x45).first);
    CHECK_FALSE(read_segment_header(0x45).last);
    CHECK(read_segment_header(0x85).last);
    CHECK(read_segment_header(0x85).pseudo_packet == 5);
}

}  // namespace common_proximity_frame_test
