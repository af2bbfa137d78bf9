// SPDX-License-Identifier: Apache-2.0
#include "common/cltu.hpp"
#include "common/randomiser.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

namespace common_cltu_test {

using namespace aeolis;

TEST_CASE("a published CLTU is taken apart and put together again the same", "[common]") {
    const auto known = test::hex("EB90 2062042900C10036 0102030405060770 08090A0BAABBCCC4 DDEEFFAABBCCDDE6 "
                                 "EEFFAABBCCDDEE10 FFAABBCCDDEEFF64 C5C5C5C5C5C5C579");
    std::vector<std::uint8_t> information(cltu_information_octets_max);
    const auto size = read_cltu(known, information);
    REQUIRE(size);
    CHECK(*size == 42);
    std::vector<std::uint8_t> written(cltu_octets_max);
    written.resize(write_cltu(std::span{information}.first(*size), written));
    CHECK(written == known);
}

TEST_CASE("a published randomised CLTU holds the published frame", "[common]") {
    const auto known = test::hex("EB90 FF429A5468E804BE F6688C29A63957C2 0255555555555556 C5C5C5C5C5C5C579");
    std::vector<std::uint8_t> information(cltu_information_octets_max);
    const auto size = read_cltu(known, information);
    REQUIRE(size);
    information.resize(*size);
    randomise_tc(information);
    const auto frame = read_tc_frame(information);
    // The frame of the vector has no CRC: its ten octets of data end where the header's length says.
    CHECK_FALSE(frame);
    CHECK(((information[0] & 3) << 8 | information[1]) == 123);
    CHECK(information[2] >> 2 == 1);
    CHECK((((information[2] & 3) << 8) | information[3]) + 1 == 15);
    CHECK(test::copy_of(std::span{information}.subspan(tc_frame_header_octets, 10)) ==
          test::hex("0102030405060708090a"));
}

TEST_CASE("every telecommand frame comes back out of its CLTU", "[common]") {
    std::mt19937 random{6};
    std::vector<std::uint8_t> frame(tc_frame_octets_max), cltu(cltu_octets_max), back(cltu_information_octets_max);
    for (std::size_t data_octets = 1; data_octets <= tc_frame_data_octets_max; ++data_octets) {
        const auto data = test::random_octets(random, data_octets);
        const std::size_t size = write_tc_frame({.spacecraft = 76, .sequence = 9}, data, frame);
        const std::size_t unit = write_cltu(std::span{frame}.first(size), cltu);
        const auto information = read_cltu(std::span{cltu}.first(unit), back);
        REQUIRE(information);
        REQUIRE(*information >= size);
        const auto read = read_tc_frame(std::span{back}.first(*information));
        REQUIRE(read);
        REQUIRE(test::copy_of(read->data) == data);
    }
}

TEST_CASE("one or two wrong bits in a code block end the CLTU there", "[common]") {
    std::vector<std::uint8_t> cltu(cltu_octets(7)), back(cltu_information_octets_max);
    write_cltu(test::hex("20620429 00C100"), cltu);
    for (std::size_t first = 16; first < 79; ++first)
        for (std::size_t second = first; second < 79; ++second) {
            auto damaged = cltu;
            damaged[first / 8] = static_cast<std::uint8_t>(damaged[first / 8] ^ (0x80U >> (first % 8)));
            if (second != first)
                damaged[second / 8] = static_cast<std::uint8_t>(damaged[second / 8] ^ (0x80U >> (second % 8)));
            REQUIRE(read_cltu(damaged, back).why() == Malformed::bad_checksum);
        }
}

TEST_CASE("a CLTU without start, cut, or too long for its reader is refused with the reason", "[common]") {
    std::vector<std::uint8_t> cltu(cltu_octets(21)), back(cltu_information_octets_max);
    write_cltu(std::vector<std::uint8_t>(21, 0xA5), cltu);
    for (std::size_t size = 0; size < cltu.size(); ++size)
        CHECK(read_cltu(std::span{cltu}.first(size), back).why() == Malformed::too_short);
    CHECK(read_cltu(cltu, std::span{back}.first(20)).why() == Malformed::too_long);
    cltu[0] = 0xEA;
    CHECK(read_cltu(cltu, back).why() == Malformed::no_start);
}

}  // namespace common_cltu_test
