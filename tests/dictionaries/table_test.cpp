// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/spreadsheet/table.hpp"
#include "tests/support/catch.hpp"

namespace dictionaries_table_test {

using namespace aeolis::dictionary;

TEST_CASE("a cell is read as what it should be, and a finding names row and column", "[dictionary][R13]") {
    std::vector<Finding> all;
    Findings findings{"f.csv", all};
    const auto table = Table::read("name,offset,count,flag\n"
                                   "good,-2.5,3,yes\n"
                                   "off,0.3,x,perhaps\n"
                                   "none,undefined,9,no\n",
                                   {"flag", "name", "count", "offset"}, findings);
    REQUIRE(table);
    RowReader good{*table, table->rows()[0], "row", "name", findings};
    CHECK(good.offset("offset") == -2.5);
    CHECK(good.integer("count", 0, 9) == 3);
    CHECK(good.yes_or_no("flag"));
    CHECK(all.empty());

    RowReader off{*table, table->rows()[1], "row", "name", findings};
    CHECK_FALSE(off.offset("offset"));
    CHECK_FALSE(off.integer("count", 0, 9));
    off.yes_or_no("flag");
    REQUIRE(all.size() == 3);
    CHECK(all[0].text() == "f.csv:3: row 'off': offset 0.3 is not a multiple of 1/64 s");
    CHECK(all[1].text() == "f.csv:3: row 'off': count 'x' is not a whole number from 0 to 9");
    CHECK(all[2].text() == "f.csv:3: row 'off': flag 'perhaps' is neither yes nor no");

    RowReader none{*table, table->rows()[2], "row", "name", findings};
    CHECK_FALSE(none.offset("offset"));
    CHECK(all.size() == 3);
}

}  // namespace dictionaries_table_test
