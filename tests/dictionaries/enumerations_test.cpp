// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/enumerations.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>

namespace dictionaries_enumerations_test {

using namespace aeolis;

TEST_CASE("each enumeration of packets and commands is listed once", "[dictionary][R48]") {
    const auto& dictionary = tests::shipped_dictionary();
    std::vector<std::string> names;
    for (const auto* type : dictionary::enumerations_of(dictionary.packets, dictionary.commands))
        names.push_back(type->name);
    for (const char* name : {"EdlPhase", "GncMode", "Decision", "Quantity"})
        CHECK(std::ranges::count(names, name) == 1);
    std::ranges::sort(names);
    CHECK(std::ranges::adjacent_find(names) == names.end());
}

}  // namespace dictionaries_enumerations_test
