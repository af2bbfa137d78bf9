#include "flight/gnc/quantities.hpp"
#include "tests/support/catch.hpp"

using namespace aeolis::flight::gnc;

TEST_CASE("a condition holds on its bound and says what it compared", "[gnc][R38]") {
    CHECK(at_most(Quantity::speed_mps, 405.0, 405.0).holds);
    CHECK_FALSE(at_most(Quantity::speed_mps, 405.1, 405.0).holds);
    CHECK(at_least(Quantity::drag_mps2, 1.96, 1.96).holds);
    CHECK_FALSE(below(Quantity::altitude_m, 5.0, 5.0).holds);
    CHECK(at_most(Quantity::speed_mps, 1.0, 2.0).comparison == Condition::Comparison::le);
}

TEST_CASE("a decision without conditions is never now", "[gnc][R38]") {
    Conditions conditions;
    CHECK_FALSE(all_hold(conditions));
    conditions.push_back(at_most(Quantity::speed_mps, 1.0, 2.0));
    CHECK(all_hold(conditions));
    conditions.push_back(at_least(Quantity::speed_mps, 1.0, 2.0));
    CHECK_FALSE(all_hold(conditions));
}
