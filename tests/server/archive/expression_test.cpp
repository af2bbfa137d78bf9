// SPDX-License-Identifier: Apache-2.0
#include "server/archive/expression.hpp"

#include "tests/support/catch.hpp"

#include <cmath>

namespace archive_expression_test {

using aeolis::archive::Expression;

namespace {

std::string refusal(const std::string& text) {
    const auto parsed = Expression::parse(text);
    return parsed ? "" : parsed.error().message;
}

}  // namespace

TEST_CASE("a formula computes with channels by name, and in braces by any name", "[expression]") {
    auto speed = Expression::parse("sqrt(vx_mps^2 + {GNC-0102}^2) * 2 - vx_mps");
    REQUIRE(speed);
    CHECK(speed->channels() == std::vector<std::string>{"vx_mps", "GNC-0102"});
    CHECK(speed->value(std::vector{3.0, 4.0}) == 7.0);
    CHECK(speed->value(std::vector{0.0, 1.0}) == 2.0);
    CHECK(Expression::parse("max(a, b) > 2 ? a : {b}")->value(std::vector{3.0, 9.0}) == 3.0);
    CHECK(std::isnan(Expression::parse("sqrt(a)")->value(std::vector{-1.0})));
}

TEST_CASE("an error names the character of the formula as it was written", "[expression]") {
    CHECK_THAT(refusal("{GNC-0101} + * 2"), Catch::StartsWith("expression, character 14: ") && Catch::Contains("*"));
    CHECK_THAT(refusal("altitude_m + nonsense(2)"), Catch::StartsWith("expression, character "));
    CHECK(refusal("a + {b") == "expression, character 5: '{' without '}'");
    CHECK(refusal("a} + 1") == "expression, character 2: '}' without '{'");
    CHECK(refusal("{} + 1") == "expression, character 1: there is no name in the braces");
    CHECK_THAT(refusal("(a + 2"), Catch::StartsWith("expression, character "));
    CHECK(refusal("1 + 2") == "expression: it names no channel");
    CHECK_THAT(refusal(""), Catch::StartsWith("expression"));
}

TEST_CASE("a formula only computes: it assigns nothing, holds no texts, gives one value, and has a limited length",
          "[expression]") {
    CHECK(refusal("a = 3") == "expression, character 3: nothing can be assigned; a comparison is ==");
    CHECK(refusal("a == 3").empty());
    CHECK(refusal("a <= 3 && a != 2").empty());
    CHECK_THAT(refusal("a + \"x\""), Catch::Contains("there are no texts"));
    CHECK_THAT(refusal("a, b"), Catch::Contains("one is wanted"));
    CHECK(refusal("a" + std::string(1000, ' ')) == "expression: 1001 octets, at most 1000");
    std::string many = "c0";
    for (int i = 1; i <= 16; ++i) many += "+c" + std::to_string(i);
    CHECK_THAT(refusal(many), Catch::Contains("more than 16 channels"));
}

}  // namespace archive_expression_test
