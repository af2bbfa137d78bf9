// SPDX-License-Identifier: Apache-2.0
#include "telemetry/recent_map.hpp"
#include "tests/support/catch.hpp"

#include <vector>

namespace telemetry_recent_map_test {

using aeolis::telemetry::RecentMap;

TEST_CASE("of more values than there is room for, the one asked for longest ago is forgotten", "[telemetry][R54]") {
    RecentMap<int, int> map{3};
    std::vector<int> forgotten;
    const auto forget = [&](int key, int value) { forgotten.push_back(100 * key + value); };
    for (const int key : {1, 2, 3}) map.at(key, forget) = 10 * key;
    CHECK(map.at(1, forget) == 10);
    CHECK(forgotten.empty());
    map.at(4, forget) = 40;
    map.at(5, forget) = 50;
    CHECK(forgotten == std::vector{220, 330});
    CHECK(map.size() == 3);
    CHECK(map.at(2, forget) == 0);
    int sum = 0;
    map.each([&](int, int value) { sum += value; });
    CHECK(sum == 40 + 50);
}

}  // namespace telemetry_recent_map_test
