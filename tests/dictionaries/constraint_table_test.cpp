// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/autocoder/constraint_table.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/mission_copy.hpp"

namespace dictionaries_constraint_table_test {

using namespace aeolis;

TEST_CASE("each constraint's code names its row of the spreadsheet, and its moments as symbols",
          "[dictionary][autocoder][R39][R40]") {
    const auto loaded = dictionary::load(tests::shipped_mission);
    REQUIRE(loaded.dictionary);
    const std::string source = dictionary::autocoder::constraint_table(*loaded.dictionary);
    const auto& constraints = loaded.dictionary->constraints;
    CHECK_THAT(source, Catch::Contains("{Moment::of_do_edl(), Moment::of_anchor(anchor::entry), "));
    CHECK_THAT(source, Catch::Contains("{Moment::of_fired(timepoint::coolant_vent), "
                                       "Moment::of_triggered(timepoint::uhf_start), 20.0, std::nullopt},\n"));
    for (const auto& row : constraints)
        CHECK_THAT(source,
                   Catch::Contains("#line " + std::to_string(row.line) + " \"constraints.csv\"\n    {Moment::"));
}

}  // namespace dictionaries_constraint_table_test
