// SPDX-License-Identifier: Apache-2.0
#include "flight/explanation/explanation.hpp"

#include "tests/support/catch.hpp"

#include <array>

namespace flight_explanation_test {

using namespace aeolis::flight;

TEST_CASE("an explanation has each condition in its place, and none beyond them", "[explanation][R38]") {
    const std::array conditions{at_most(Quantity::speed_mps, 407.0, 405.0), above(Quantity::tone_priority, 4, 3),
                                names(Quantity::next_tone, 7)};
    const auto e = explanation(Decision::parachute_deploy, ExplanationVerdict::held, 3, conditions, 12);
    CHECK(e.condition_count == 3);
    CHECK(e.subject == 3);
    CHECK(e.suppressed == 12);
    CHECK(e.condition_1 == Quantity::speed_mps);
    CHECK(e.comparison_1 == Comparison::le);
    CHECK_FALSE(e.holds_1);
    CHECK(e.comparison_2 == Comparison::gt);
    CHECK(e.holds_2);
    CHECK(e.value_3 == 7.0);
    CHECK(e.condition_4 == Quantity::none);
}

TEST_CASE("a comparison holds at its bound or just beside it, as it says", "[explanation][R38]") {
    CHECK(at_most(Quantity::speed_mps, 405.0, 405.0).holds);
    CHECK(at_least(Quantity::speed_mps, 405.0, 405.0).holds);
    CHECK_FALSE(below(Quantity::speed_mps, 405.0, 405.0).holds);
    CHECK_FALSE(above(Quantity::speed_mps, 405.0, 405.0).holds);
}

}  // namespace flight_explanation_test
