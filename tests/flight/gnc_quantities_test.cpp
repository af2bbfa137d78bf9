#include "flight/gnc/quantities.hpp"
#include "generated/dictionary_flight.hpp"
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

TEST_CASE("GNC's quantities have the numbers of the dictionary", "[gnc][R38]") {
    using Ground = aeolis::flight::Quantity;
    const auto same = [](Quantity ours, Ground dictionary) {
        return static_cast<unsigned>(ours) == static_cast<unsigned>(dictionary);
    };
    CHECK(same(Quantity::none, Ground::none));
    CHECK(same(Quantity::speed_mps, Ground::speed_mps));
    CHECK(same(Quantity::altitude_m, Ground::altitude_m));
    CHECK(same(Quantity::drag_mps2, Ground::drag_mps2));
    CHECK(same(Quantity::descent_rate_mps, Ground::descent_rate_mps));
    CHECK(same(Quantity::time_since_parachute_s, Ground::time_since_parachute_s));
    CHECK(same(Quantity::range_to_go_m, Ground::range_to_go_m));
    CHECK(same(Quantity::crossrange_m, Ground::crossrange_m));
    CHECK(same(Quantity::thrust_N, Ground::thrust_N));
    CHECK(same(Quantity::time_to_parachute_s, Ground::time_to_parachute_s));
    CHECK(same(Quantity::time_to_backshell_s, Ground::time_to_backshell_s));
    CHECK(same(Quantity::cycles_held, Ground::cycles_held));
    CHECK(same(Quantity::radar_beams, Ground::radar_beams));
    CHECK(same(Quantity::time_in_mode_s, Ground::time_in_mode_s));
}
