// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/autocoder/timeline_source.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/mission_copy.hpp"

namespace dictionaries_timeline_source_test {

using namespace aeolis;

TEST_CASE("each timepoint's code names its row of the spreadsheet, and its action and event as symbols",
          "[dictionary][autocoder][R20][R40]") {
    const auto loaded = dictionary::load(tests::shipped_mission);
    REQUIRE(loaded.dictionary);
    const std::string source = dictionary::autocoder::timeline_source(*loaded.dictionary);
    for (const auto& row : loaded.dictionary->timeline) {
        INFO(row.name);
        const std::size_t begin =
            source.find("#line " + std::to_string(row.line) + " \"timeline.csv\"\n    {\"" + row.name);
        REQUIRE(begin != std::string::npos);
        const std::string code = source.substr(begin, source.find("\n", source.find("\n", begin) + 1) - begin);
        if (!row.action.empty()) CHECK_THAT(code, Catch::Contains("action_named<\"" + row.action + "\">().run,"));
        if (!row.event.empty()) CHECK_THAT(code, Catch::Contains("&announce<evr::" + row.event + ">"));
        if (!row.desired_offset_s) CHECK_THAT(code, Catch::Contains("std::nullopt"));
    }
}

}  // namespace dictionaries_timeline_source_test
