// SPDX-License-Identifier: Apache-2.0
#include "common/bytes.hpp"
#include "tests/support/catch.hpp"

#include <array>
#include <random>
#include <vector>

namespace common_bytes_test {

using namespace aeolis;

TEST_CASE("bit fields are written most significant bit first", "[common]") {
    std::array<std::uint8_t, 2> octets{};
    BitWriter writer{octets};
    writer.put(0b101, 3);
    writer.put(0x1FF, 9);
    writer.put(0, 4);
    CHECK(octets[0] == 0b10111111);
    CHECK(octets[1] == 0b11110000);
}

TEST_CASE("any sequence of fields reads back as it was written", "[common]") {
    std::mt19937_64 random{1};
    for (int round = 0; round < 200; ++round) {
        std::array<std::uint8_t, 128> octets{};
        std::vector<std::pair<std::uint64_t, unsigned>> fields;
        BitWriter writer{octets};
        while (true) {
            const auto bits = static_cast<unsigned>(random() % 64 + 1);
            if (writer.position_bits() + bits > octets.size() * 8) break;
            const std::uint64_t value = bits == 64 ? random() : random() & ((1ULL << bits) - 1);
            writer.put(value, bits);
            fields.emplace_back(value, bits);
        }
        BitReader reader{octets};
        for (const auto& [value, bits] : fields) REQUIRE(reader.get(bits) == value);
    }
}

TEST_CASE("octets are written where the fields before them end, on an octet or not", "[common]") {
    std::array<std::uint8_t, 4> octets{};
    BitWriter out{octets};
    out.put(0xA, 4);
    out.put_octets(std::array<std::uint8_t, 2>{0x12, 0x34});
    CHECK(octets == std::array<std::uint8_t, 4>{0xA1, 0x23, 0x40, 0});
    CHECK(out.position_bits() == 20);
}

TEST_CASE("negative numbers keep their sign in any width", "[common]") {
    std::array<std::uint8_t, 8> octets{};
    BitWriter writer{octets};
    writer.put_signed(-5, 4);
    writer.put_signed(-1, 13);
    writer.put_signed(7, 4);
    BitReader reader{octets};
    CHECK(reader.get_signed(4) == -5);
    CHECK(reader.get_signed(13) == -1);
    CHECK(reader.get_signed(4) == 7);
}

TEST_CASE("writing or reading past the end is a bug, not a silent loss", "[common]") {
    std::array<std::uint8_t, 1> octets{};
    BitWriter writer{octets};
    CHECK_THROWS_AS(writer.put(0, 9), CheckFailed);
    CHECK_THROWS_AS(read_bits(octets, 4, 5), CheckFailed);
    CHECK_FALSE(BitReader{octets}.has(9));
}

}  // namespace common_bytes_test
