// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/analysis/difference_network.hpp"
#include "tests/support/catch.hpp"

#include <set>

namespace dictionaries_difference_network_test {

using namespace aeolis::dictionary;

TEST_CASE("the earliest solution keeps every least difference, and no moment could be earlier", "[timeline][R19]") {
    DifferenceNetwork network{4};
    network.add({0, 1, 5});
    network.add({1, 2, 3});
    network.add({0, 2, 10});
    network.add({2, 3, -4});
    CHECK(network.earliest().ticks == std::vector<std::int64_t>{0, 5, 10, 6});
    network.add({2, 1, -4});  // moment 1 no more than 4 before moment 2
    CHECK(network.earliest().ticks == std::vector<std::int64_t>{0, 6, 10, 6});
}

TEST_CASE("edges that contradict one another are named as a ring", "[timeline][R19]") {
    DifferenceNetwork network{4};
    network.add({0, 1, 1});
    const auto there = network.add({1, 2, 3});
    const auto back = network.add({2, 1, -2});
    network.add({2, 3, 1});
    const auto earliest = network.earliest();
    CHECK(earliest.ticks.empty());
    CHECK(std::set<std::size_t>{earliest.contradiction.begin(), earliest.contradiction.end()} ==
          std::set<std::size_t>{there, back});
    network.remove_last();
    network.remove_last();
    CHECK(network.earliest().contradiction.empty());
}

TEST_CASE("the least difference is the longest path, and is none where no path leads", "[timeline][R19]") {
    DifferenceNetwork network{4};
    network.add({0, 1, 2});
    const auto first = network.add({0, 2, 1});
    const auto second = network.add({2, 1, 4});
    network.add({1, 3, -9});
    const auto path = network.least_difference(0, 1);
    REQUIRE(path);
    CHECK(path->ticks == 5);
    CHECK(path->edges == std::vector<std::size_t>{first, second});
    CHECK(network.least_difference(0, 3)->ticks == -4);
    CHECK_FALSE(network.least_difference(3, 0));
    CHECK(network.least_difference(2, 2)->ticks == 0);
}

}  // namespace dictionaries_difference_network_test
