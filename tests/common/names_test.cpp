// SPDX-License-Identifier: Apache-2.0
#include "common/names.hpp"

#include "tests/support/catch.hpp"

#include <random>
#include <string>
#include <vector>

namespace common_names_test {

using namespace aeolis;

TEST_CASE("the distance of two names is the letters to put in, take out or replace", "[common]") {
    CHECK(edit_distance("", "") == 0);
    CHECK(edit_distance("stop_uhf", "stop_uhf") == 0);
    CHECK(edit_distance("vent_colant", "vent_coolant") == 1);
    CHECK(edit_distance("", "abc") == 3);
    CHECK(edit_distance("abcd", "acbd") == 2);
    CHECK(edit_distance(std::string(200, 'a'), std::string(300, 'a')) == 0);  // both cut
}

TEST_CASE("the distance of names is that of either way, and never more than their letters", "[common]") {
    std::mt19937 random{7};
    const auto any = [&] {
        std::string name(random() % 12, 'a');
        for (char& letter : name) letter = static_cast<char>('a' + random() % 3);
        return name;
    };
    for (int i = 0; i < 2000; ++i) {
        const std::string a = any();
        const std::string b = any();
        const std::string c = any();
        REQUIRE(edit_distance(a, b) == edit_distance(b, a));
        REQUIRE(edit_distance(a, b) <= std::max(a.size(), b.size()));
        REQUIRE((edit_distance(a, b) == 0) == (a == b));
        REQUIRE(edit_distance(a, c) <= edit_distance(a, b) + edit_distance(b, c));
    }
}

TEST_CASE("the nearest name is the first of the nearest; of none there is none", "[common]") {
    const std::vector<std::string_view> all{"arm", "stop_uhf", "start_uhf"};
    CHECK(nearest("stopp_uhf", all) == "stop_uhf");
    CHECK(nearest("arm", all) == "arm");
    CHECK(nearest("arm", std::vector<std::string_view>{}).empty());
}

}  // namespace common_names_test
