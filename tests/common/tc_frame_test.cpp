// SPDX-License-Identifier: Apache-2.0
#include "common/tc_frame.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

namespace common_tc_frame_test {

using namespace aeolis;

TEST_CASE("a published telecommand frame reads as published, and is written the same", "[common]") {
    const auto known = test::hex("207B001717C1000102030405060708090A0B0C0D0E0F0DEF");
    const auto frame = read_tc_frame(known);
    REQUIRE(frame);
    CHECK(frame->header == TcFrameHeader{true, false, 123, 0, 23});
    CHECK(frame->data.size() == 17);
    std::vector<std::uint8_t> written(tc_frame_octets_max);
    written.resize(write_tc_frame(frame->header, frame->data, written));
    CHECK(written == known);
}

TEST_CASE("every telecommand frame reads back, with fill behind it or without", "[common]") {
    std::mt19937 random{3};
    std::vector<std::uint8_t> octets(tc_frame_octets_max + 6, 0x55);
    for (int round = 0; round < 2000; ++round) {
        const auto data = test::random_octets(random, 1 + random() % tc_frame_data_octets_max);
        const TcFrameHeader header{random() % 2 == 0, random() % 2 == 0, static_cast<std::uint16_t>(random() % 1024),
                                   static_cast<std::uint8_t>(random() % 64), static_cast<std::uint8_t>(random())};
        const std::size_t size = write_tc_frame(header, data, octets);
        const auto frame = read_tc_frame(std::span{octets}.first(size + random() % 7));
        REQUIRE(frame);
        REQUIRE(frame->header == header);
        REQUIRE(test::copy_of(frame->data) == data);
    }
}

TEST_CASE("a telecommand frame that is cut or has one bit wrong is refused with the reason", "[common]") {
    std::mt19937 random{4};
    std::vector<std::uint8_t> octets(tc_frame_octets_max);
    octets.resize(write_tc_frame({.spacecraft = 76}, test::random_octets(random, 30), octets));
    for (std::size_t size = 0; size < octets.size(); ++size)
        CHECK(read_tc_frame(std::span{octets}.first(size)).why() == Malformed::too_short);
    for (std::size_t bit = 0; bit < octets.size() * 8; ++bit) {
        auto damaged = octets;
        damaged[bit / 8] = static_cast<std::uint8_t>(damaged[bit / 8] ^ (1U << (bit % 8)));
        REQUIRE_FALSE(read_tc_frame(damaged));
    }
    CHECK(read_tc_frame(test::hex("607B00171700000000")).why() == Malformed::other_version);
    CHECK(read_tc_frame(test::hex("007B00061700000000")).why() == Malformed::bad_field);
}

TEST_CASE("published CLCWs read as published", "[common]") {
    const auto first = read_clcw(test::hex("0002A689"));
    REQUIRE(first);
    CHECK(first->cop == 0);
    CHECK(first->expected == 137);
    CHECK(first->farm_b == 3);
    CHECK(first->no_rf);
    CHECK(first->lockout);
    CHECK_FALSE(first->retransmit);
    const auto second = read_clcw(test::hex("0002D0D4"));
    REQUIRE(second);
    CHECK(second->expected == 212);
    CHECK(second->farm_b == 0);
}

TEST_CASE("every CLCW reads back; one of another type, version or length does not", "[common]") {
    std::mt19937 random{5};
    for (int round = 0; round < 2000; ++round) {
        const auto flag = [&] { return random() % 2 == 0; };
        const Clcw clcw{static_cast<std::uint8_t>(random() % 4),
                        static_cast<std::uint8_t>(random() % 64),
                        flag(),
                        flag(),
                        flag(),
                        flag(),
                        flag(),
                        static_cast<std::uint8_t>(random() % 4),
                        static_cast<std::uint8_t>(random())};
        std::array<std::uint8_t, clcw_octets> octets{};
        write_clcw(clcw, octets);
        REQUIRE(read_clcw(octets));
        REQUIRE(*read_clcw(octets) == clcw);
    }
    CHECK(read_clcw(test::hex("80000000")).why() == Malformed::bad_field);
    CHECK(read_clcw(test::hex("20000000")).why() == Malformed::other_version);
    CHECK(read_clcw(test::hex("000000")).why() == Malformed::too_short);
    CHECK(read_clcw(test::hex("0000000000")).why() == Malformed::too_long);
}

}  // namespace common_tc_frame_test
