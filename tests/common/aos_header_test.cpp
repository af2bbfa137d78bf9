// SPDX-License-Identifier: Apache-2.0
#include "common/aos_header.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

#include <algorithm>

namespace common_aos_header_test {

using namespace aeolis;

namespace {

AosHeader header_of(std::string_view hex) {
    AosHeader header{};
    std::ranges::copy(test::hex(hex), header.begin());
    return header;
}

constexpr std::array<std::size_t, 10> places{0, 1, 2, 3, 10, 11, 12, 13, 14, 15};  // protected symbols, of four bits

void damage(AosHeader& header, std::size_t place, unsigned error) {
    header.at(places.at(place) / 2) ^= static_cast<std::uint8_t>(error << (places.at(place) % 2 == 0 ? 4U : 0U));
}

}  // namespace

// Error controls by an encoder of their own: the remainder of a polynomial division in GF(16).
const std::array<AosHeader, 4> right{header_of("40000000000 01cc1"), header_of("6ac1000157 00dd07"),
                                     header_of("5345123456 40ba72"), header_of("5345ffffff 40ba72")};

TEST_CASE("a header without errors is right, whatever its count is, which is not protected", "[common][frames]") {
    for (AosHeader header : right) CHECK(correct_aos_header(header) == 0U);
}

TEST_CASE("any one or two wrong symbols of a header are corrected", "[common][frames]") {
    for (const AosHeader& sent : right)
        for (std::size_t i = 0; i < places.size(); ++i)
            for (unsigned error = 1; error < 16; ++error) {
                AosHeader one = sent;
                damage(one, i, error);
                REQUIRE(correct_aos_header(one) == 1U);
                REQUIRE(one == sent);
                for (std::size_t k = i + 1; k < places.size(); ++k) {
                    AosHeader two = sent;
                    damage(two, i, error);
                    damage(two, k, 16 - error);
                    REQUIRE(correct_aos_header(two) == 2U);
                    REQUIRE(two == sent);
                }
            }
}

TEST_CASE("three wrong symbols are found or make another header, never the one that was sent", "[common][frames]") {
    std::mt19937 random{1};
    std::size_t refused = 0;
    constexpr std::size_t rounds = 2000;
    for (std::size_t round = 0; round < rounds; ++round) {
        AosHeader header = right[round % right.size()];
        std::array<std::size_t, 3> at{random() % 10, 0, 0};
        at[1] = (at[0] + 1 + random() % 4) % 10;
        at[2] = (at[1] + 1 + random() % 4) % 10;
        for (const std::size_t place : at) damage(header, place, 1 + random() % 15);
        const AosHeader received = header;
        if (!correct_aos_header(header)) {
            ++refused;
            CHECK(header == received);
        } else {
            CHECK(header != right[round % right.size()]);
        }
    }
    CHECK(refused > rounds / 2);
}

}  // namespace common_aos_header_test
