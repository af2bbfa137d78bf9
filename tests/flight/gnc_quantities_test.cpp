// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/quantities.hpp"

#include "flight/gnc/edl_gnc.hpp"
#include "tests/support/catch.hpp"

#include <type_traits>

namespace flight_gnc_quantities_test {

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

TEST_CASE("GNC's quantities, comparisons and modes are the dictionary's own types", "[gnc][R38][R40][R48]") {
    STATIC_REQUIRE(std::is_same_v<Quantity, aeolis::flight::Quantity>);
    STATIC_REQUIRE(std::is_same_v<Condition::Comparison, aeolis::flight::Comparison>);
    STATIC_REQUIRE(std::is_same_v<Mode, aeolis::flight::GncMode>);
}

}  // namespace flight_gnc_quantities_test
