#include "common/crc.hpp"
#include "tests/support/catch.hpp"

#include <array>
#include <vector>

using namespace aeolis;

namespace {
constexpr std::array<std::uint8_t, 9> check{'1', '2', '3', '4', '5', '6', '7', '8', '9'};
} // namespace

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
