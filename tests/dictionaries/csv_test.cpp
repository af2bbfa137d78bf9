// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/spreadsheet/csv.hpp"
#include "tests/support/catch.hpp"

namespace dictionaries_csv_test {

using namespace aeolis::dictionary;

namespace {

struct Read {
    std::optional<Sheet> sheet;
    std::vector<Finding> findings;
};
Read read(std::string_view text) {
    Read result;
    Findings findings{"f.csv", result.findings};
    result.sheet = read_csv(text, findings);
    return result;
}

}  // namespace

TEST_CASE("what a spreadsheet program saves reads the same as what an editor saves", "[dictionary]") {
    const auto plain = read("a,b\n1,\"x, \"\"y\"\"\"\n");
    const auto saved = read("\xEF\xBB\xBF"
                            "a,b\r\n1,\"x, \"\"y\"\"\"\r\n,\r\n");
    for (const auto& one : {plain, saved}) {
        REQUIRE(one.sheet);
        CHECK(one.sheet->header.cells == std::vector<std::string>{"a", "b"});
        REQUIRE(one.sheet->rows.size() == 1);
        CHECK(one.sheet->rows[0].cells == std::vector<std::string>{"1", "x, \"y\""});
        CHECK(one.sheet->rows[0].line == 2);
    }
}

TEST_CASE("a line break within quotes keeps the count of lines", "[dictionary]") {
    const auto result = read("a,b\n\"one\ntwo\",2\n3,4\n");
    REQUIRE(result.sheet);
    CHECK(result.sheet->rows[0].line == 2);
    CHECK(result.sheet->rows[1].line == 4);
}

TEST_CASE("a fault names its line and column", "[dictionary]") {
    struct Case {
        const char* text;
        const char* finding;
    };
    for (const Case& c : {
             Case{"", "f.csv:1: the file is empty"},
             Case{"a,b\n1\n", "f.csv:2: the row has 1 cells, the header 2"},
             Case{"a,b\n1,\"2", "f.csv:2: column 3: the quote that opens here is never closed"},
             Case{"a,b\n1,2\"\n", "f.csv:2: column 4: a quote within a cell that does not begin with one"},
             Case{"a,b\n\"1\"x,2\n", "f.csv:2: column 4: a comma or the end of the line should follow the quote"},
         }) {
        const auto result = read(c.text);
        CHECK_FALSE(result.sheet);
        REQUIRE(result.findings.size() == 1);
        CHECK(result.findings.front().text() == c.finding);
    }
}

TEST_CASE("a last line without its end, and a lone carriage return, are text like any other", "[dictionary]") {
    const auto result = read("a\nx\ry");
    REQUIRE(result.sheet);
    CHECK(result.sheet->rows[0].cells[0] == "x\ry");
}

}  // namespace dictionaries_csv_test
