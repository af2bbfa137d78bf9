// SPDX-License-Identifier: Apache-2.0
#include "common/randomiser.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

namespace common_randomiser_test {

using namespace aeolis;

TEST_CASE("the random sequences begin as published, come round after 255 octets, and undo themselves", "[common]") {
    std::vector<std::uint8_t> tm(520), tc(520);
    randomise_tm(tm);
    randomise_tc(tc);
    CHECK(test::copy_of(std::span{tm}.first(8)) == test::hex("ff480ec09a0d70bc"));
    CHECK(test::copy_of(std::span{tc}.first(5)) == test::hex("ff399e5a68"));
    for (const auto& sequence : {tm, tc})
        for (std::size_t i = 0; i + 255 < sequence.size(); ++i) REQUIRE(sequence[i] == sequence[i + 255]);
    randomise_tm(tm);
    randomise_tc(tc);
    CHECK(tm == std::vector<std::uint8_t>(520));
    CHECK(tc == std::vector<std::uint8_t>(520));
}

}  // namespace common_randomiser_test
