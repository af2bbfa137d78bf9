// SPDX-License-Identifier: Apache-2.0
#include "common/crc.hpp"
#include "tests/support/catch.hpp"

#include <array>
#include <vector>

namespace common_crc_test {

using namespace aeolis;

namespace {
constexpr std::array<std::uint8_t, 9> check{'1', '2', '3', '4', '5', '6', '7', '8', '9'};
}  // namespace

TEST_CASE("CRC-16 of the check string is 29B1", "[common]") {
    CHECK(crc16(check) == 0x29B1);
    CHECK(crc16({}) == 0xFFFF);
    CHECK(crc16(std::vector<std::uint8_t>{0x00}) == 0xE1F0);
    CHECK(crc16(std::vector<std::uint8_t>{0xFF}) == 0xFF00);
}

TEST_CASE("CRC-32 of Proximity-1 of the check string is 51693C0C", "[common]") {
    CHECK(crc32_proximity(check) == 0x51693C0C);
    CHECK(crc32_proximity({}) == 0);
}

TEST_CASE("octets followed by their own CRC-16 leave a remainder of zero", "[common]") {
    std::vector<std::uint8_t> octets{check.begin(), check.end()};
    const std::uint16_t crc = crc16(octets);
    octets.push_back(static_cast<std::uint8_t>(crc >> 8));
    octets.push_back(static_cast<std::uint8_t>(crc & 0xFF));
    CHECK(crc16(octets) == 0);
}

TEST_CASE("CRCs are the remainders of long division, whatever the length", "[common]") {
    CHECK(crc32_proximity(std::vector<std::uint8_t>{0x12, 0x34, 0x56, 0x78}) == 0x34D74CB3);
    std::uint32_t noise = 1;
    for (std::size_t size = 0; size < 70; ++size) {
        std::vector<std::uint8_t> octets(size);
        std::uint32_t of_32 = 0;
        std::uint16_t of_16 = 0xFFFF;
        for (auto& octet : octets) {
            octet = static_cast<std::uint8_t>((noise = noise * 1664525U + 1013904223U) >> 24);
            of_32 ^= std::uint32_t{octet} << 24;
            of_16 = static_cast<std::uint16_t>(of_16 ^ (octet << 8));
            for (int bit = 0; bit < 8; ++bit) {
                of_32 = (of_32 & 0x80000000U) != 0 ? (of_32 << 1) ^ 0x00A00805U : of_32 << 1;
                of_16 = static_cast<std::uint16_t>((of_16 & 0x8000U) != 0 ? (of_16 << 1) ^ 0x1021U : of_16 << 1);
            }
        }
        CHECK(crc32_proximity(octets) == of_32);
        CHECK(crc16(octets) == of_16);
    }
}

TEST_CASE("a CRC-16 goes on from that of what stood before", "[common]") {
    for (std::size_t cut = 0; cut <= check.size(); ++cut)
        CHECK(crc16(std::span{check}.subspan(cut), crc16(std::span{check}.first(cut))) == 0x29B1);
}

TEST_CASE("published CRC-16 values", "[common]") {
    CHECK(crc16(std::vector<std::uint8_t>{0x06, 0x00, 0x0c, 0xf0, 0x00, 0x04, 0x00, 0x55, 0x88, 0x73, 0xc9, 0x00, 0x00,
                                          0x05, 0x21}) == 0x75FB);
    CHECK(crc16(std::vector<std::uint8_t>{0x01, 0x92, 0xFE, 0x00, 0x11, 0x82, 0x5A}) == 0x0EA3);
}

}  // namespace common_crc_test
