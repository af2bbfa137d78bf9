// SPDX-License-Identifier: Apache-2.0
#include "common/parsed.hpp"
#include "tests/support/catch.hpp"

#include <set>
#include <string>

namespace common_parsed_test {

using namespace aeolis;

TEST_CASE("what could not be read has a reason, and reading it all the same is a bug", "[common]") {
    const Parsed<int> none = Malformed::bad_checksum;
    CHECK_FALSE(none);
    CHECK(none.why() == Malformed::bad_checksum);
    CHECK_THROWS_AS(*none, CheckFailed);
    const Parsed<int> seven = 7;
    REQUIRE(seven);
    CHECK(*seven == 7);
}

TEST_CASE("each reason has a name of its own", "[common]") {
    std::set<std::string> names;
    for (int why = 0; why <= static_cast<int>(Malformed::bad_field); ++why)
        names.insert(name_of(static_cast<Malformed>(why)));
    CHECK(names.size() == static_cast<std::size_t>(Malformed::bad_field) + 1);
    CHECK(names.count("") == 0);
}

}  // namespace common_parsed_test
