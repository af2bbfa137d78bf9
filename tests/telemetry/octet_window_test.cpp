// SPDX-License-Identifier: Apache-2.0
#include "telemetry/octet_window.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

namespace telemetry_octet_window_test {

using namespace aeolis;
using namespace aeolis::telemetry;

TEST_CASE("a window holds what was added and not yet used, in order", "[telemetry]") {
    std::mt19937 random{1};
    OctetWindow window;
    std::vector<std::uint8_t> expected;
    for (int round = 0; round < 500; ++round) {
        const auto octets = test::random_octets(random, random() % 20);
        window.add(octets);
        expected.insert(expected.end(), octets.begin(), octets.end());
        const std::size_t used = random() % (expected.size() + 1);
        window.use(used);
        expected.erase(expected.begin(), expected.begin() + static_cast<std::ptrdiff_t>(used));
        REQUIRE(test::copy_of(window.rest()) == expected);
    }
    CHECK_THROWS_AS(window.use(expected.size() + 1), CheckFailed);
}

TEST_CASE("an octet is found where it first stands, or not at all", "[telemetry]") {
    const auto octets = test::hex("0102030203");
    CHECK(find_octet(octets, 2) == 1);
    CHECK(find_octet(octets, 9) == 5);
    CHECK(find_octet({}, 9) == 0);
}

}  // namespace telemetry_octet_window_test
