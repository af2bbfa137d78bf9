#include "common/crc.hpp"
#include "tests/support/catch.hpp"

#include <array>

using namespace aeolis;

namespace {
constexpr std::array<std::uint8_t, 9> check{'1', '2', '3', '4', '5', '6', '7', '8', '9'};
}

TEST_CASE("CRC-16 of the check string is 29B1", "[common]") {
    CHECK(crc16(check) == 0x29B1);
}

TEST_CASE("CRC-32 of Proximity-1 of the check string is 51693C0C", "[common]") {
    CHECK(crc32_proximity(check) == 0x51693C0C);
}
