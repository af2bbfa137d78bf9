// SPDX-License-Identifier: Apache-2.0
#include "server/api/query_text.hpp"
#include "tests/support/catch.hpp"

namespace server_query_text_test {

using namespace aeolis::server;

TEST_CASE("a query's values are decoded", "[http]") {
    const auto query =
        QueryText::parse("text=a%20b+c&from=-1.5&limit=0x10&names=x,,y", {"text", "from", "limit", "names"});
    REQUIRE(query);
    CHECK(query->text("text") == "a b c");
    CHECK(**query->number("from") == -1.5);
    CHECK(**query->count("limit", 100) == 16);
    CHECK(query->list("names") == std::vector<std::string>{"x", "y"});
    CHECK_FALSE(query->number("to")->has_value());
}

TEST_CASE("a value that is one of some words is the first of them when it is left out, and none other", "[http]") {
    constexpr std::array<std::string_view, 2> formats{"json", "csv"};
    const auto format = [&](const char* text) { return QueryText::parse(text, {"format"})->one_of("format", formats); };
    CHECK(*format("") == "json");
    CHECK(*format("format=csv") == "csv");
    CHECK(format("format=CSV").error().message == "format: 'CSV' is none of json, csv");
    CHECK_FALSE(format("format="));
}

TEST_CASE("a wrong query is refused by the name of what is wrong", "[http]") {
    CHECK(QueryText::parse("form=1", {"from", "to"}).error().message ==
          "unknown parameter 'form'; known here: from, to");
    CHECK(QueryText::parse("from=1&from=2", {"from"}).error().message == "parameter 'from' is given twice");
    CHECK_FALSE(QueryText::parse("from=%zz", {"from"}));
    const auto query =
        QueryText::parse("from=1x&to=nan&limit=-1&after=99999999999999999999", {"from", "to", "limit", "after"});
    REQUIRE(query);
    CHECK(query->number("from").error().message == "from: '1x' is not a number");
    CHECK(query->number("to").error().message == "to: 'nan' is not a number");
    CHECK(query->count("limit", 10).error().message == "limit: '-1' is not a whole number from 0");
    CHECK_FALSE(query->count("after", 10));
    CHECK(QueryText::parse("limit=0", {"limit"})->amount("limit", 10).error().message == "limit: 0 asks for nothing");
    CHECK(**QueryText::parse("limit=0", {"limit"})->count("limit", 10) == 0);
}

}  // namespace server_query_text_test
