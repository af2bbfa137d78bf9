// SPDX-License-Identifier: Apache-2.0
#include "commands/number.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/small_dictionary.hpp"

#include <cstdlib>
#include <random>

namespace commands_number_test {

using namespace aeolis;
using namespace aeolis::commands;

TEST_CASE("the shortest text of a number gives the same number again", "[number][property]") {
    CHECK(shortest_text(405.0) == "405");
    CHECK(shortest_text(-4.5893) == "-4.5893");
    std::mt19937_64 random{7};
    for (int round = 0; round < 10'000; ++round) {
        const auto value = std::bit_cast<double>(random());
        if (value != value) continue;
        REQUIRE(std::strtod(shortest_text(value).c_str(), nullptr) == value);
    }
}

TEST_CASE("a field's bits are a number by its encoding", "[number]") {
    CHECK(number_of(tests::u(16), 0xFFFF) == 65535.0);
    CHECK(number_of(tests::number("1", dictionary::Encoding::twos_complement, 12), 0xFFF) == -1.0);
    CHECK(number_of(tests::f32("1"), 0x43CA8000) == 405.0);
    CHECK(number_of(tests::f64("1"), std::bit_cast<std::uint64_t>(-4.5893)) == -4.5893);
}

TEST_CASE("SCLK reads to a millisecond", "[number]") {
    CHECK(text_of(Sclk{397501022.15625}) == "397501022.156");
}

}  // namespace commands_number_test
