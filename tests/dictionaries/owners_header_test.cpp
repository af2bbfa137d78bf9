// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/autocoder/owners_header.hpp"
#include "flight/timeline/actions.hpp"
#include "generated/owners.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

namespace dictionaries_owners_header_test {

using namespace aeolis;

TEST_CASE("each owner's code names its row of the spreadsheet, and its module as a symbol",
          "[dictionary][autocoder][R5][R40]") {
    const auto& dictionary = tests::shipped_dictionary();
    const std::string header = dictionary::autocoder::owners_header(dictionary);
    for (const auto& row : dictionary.owners) {
        INFO(row.name);
        const auto at = header.find("#line " + std::to_string(row.line) + " \"owners.csv\"\n");
        REQUIRE(at != std::string::npos);
        const std::string code = header.substr(at, header.find(";", at) - at);
        CHECK_THAT(code, Catch::Contains(row.name));
        CHECK_THAT(code, Catch::Contains("ModuleId::" + row.module));
    }
}

TEST_CASE("flight knows the owners at compile time", "[dictionary][R5]") {
    using namespace aeolis::flight;
    STATIC_REQUIRE(owner_of(Decision::tone) == ModuleId::mfsk);
    STATIC_REQUIRE(owner_of(DeviceLine::pyros) == ModuleId::pyro);
    STATIC_REQUIRE(action_named<"fire_parachute_mortar">().owner == ModuleId::pyro);
}

}  // namespace dictionaries_owners_header_test
