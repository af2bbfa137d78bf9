// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/entry/lateral_logic.hpp"
#include "generated/dictionary_flight.hpp"
#include "tests/support/catch.hpp"

namespace flight_gnc_lateral_logic_test {

using namespace aeolis;
using namespace aeolis::flight::gnc;
constexpr aeolis::flight::Parameters parameters;

namespace {

constexpr Sclk now{1000.0};
constexpr double interval_s = parameters.reversal_interval_min_s;

/// `settled`: the bank is on the commanded side.
bool reverses(LateralLogic& logic, Sclk at, double crossrange_m, double velocity_mps, bool saturated, bool settled) {
    return all_hold(logic.on(parameters, at, crossrange_m, velocity_mps, saturated, is(Quantity::bank_deg, settled)));
}

}  // namespace

TEST_CASE("the deadband shrinks with velocity and is halved when lift is saturated", "[gnc][R27]") {
    CHECK(crossrange_deadband_m(parameters, 5000.0, false) > crossrange_deadband_m(parameters, 2000.0, false));
    CHECK(crossrange_deadband_m(parameters, 2000.0, true) ==
          Approx(parameters.saturated_deadband_fraction * crossrange_deadband_m(parameters, 2000.0, false)));
}

TEST_CASE("bank reverses when the target has left the deadband on the side away from lift", "[gnc][R27]") {
    LateralLogic logic;
    logic.start(1);
    const double edge_m = crossrange_deadband_m(parameters, 3000.0, false);
    CHECK_FALSE(reverses(logic, now, +2.0 * edge_m, 3000.0, false, true));  // lift already turns towards it
    CHECK_FALSE(reverses(logic, now, -0.99 * edge_m, 3000.0, false, true));
    CHECK(reverses(logic, now, -1.01 * edge_m, 3000.0, false, true));
    CHECK(logic.sign() == -1);
    CHECK(logic.reversals() == 1);
    CHECK_FALSE(reverses(logic, now + interval_s, -1.01 * edge_m, 3000.0, false, true));
    CHECK(reverses(logic, now + interval_s, +1.01 * edge_m, 3000.0, false, true));
    CHECK(logic.reversals() == 2);
}

TEST_CASE("no reversal is asked for before the last one is flown", "[gnc][R27]") {
    LateralLogic logic;
    logic.start(1);
    CHECK_FALSE(reverses(logic, now, -1.0e6, 3000.0, false, false));
    CHECK(logic.reversals() == 0);
}

TEST_CASE("a reversal comes no sooner than the least time after the last", "[gnc][R27]") {
    LateralLogic logic;
    logic.start(1);
    REQUIRE(reverses(logic, now, -1.0e6, 3000.0, false, true));
    CHECK_FALSE(reverses(logic, now + (interval_s - seconds_per_tick), +1.0e6, 3000.0, false, true));
    CHECK(reverses(logic, now + interval_s, +1.0e6, 3000.0, false, true));
}

TEST_CASE("a reversal tells the crossrange that it found beyond the deadband, the bank and the time since the last",
          "[gnc][R27][R38]") {
    LateralLogic logic;
    logic.start(1);
    const Condition settled = above(Quantity::bank_deg, 61.0, 0.0);
    const double edge_m = crossrange_deadband_m(parameters, 3000.0, false);
    const Conditions first = logic.on(parameters, now, -1.01 * edge_m, 3000.0, false, settled);
    REQUIRE(first.size() == 2);
    CHECK(first[0].quantity == Quantity::crossrange_m);
    CHECK(first[0].value == -1.01 * edge_m);
    CHECK(first[0].bound == -edge_m);
    CHECK(first[0].comparison == Condition::Comparison::lt);
    CHECK(first[1].value == 61.0);
    const Conditions second =
        logic.on(parameters, now + interval_s, 1.01 * edge_m, 3000.0, false, below(Quantity::bank_deg, -61.0, 0.0));
    REQUIRE(second.size() == 3);
    CHECK(second[0].bound == edge_m);
    CHECK(second[0].comparison == Condition::Comparison::gt);
    CHECK(second[2].quantity == Quantity::time_since_reversal_s);
    CHECK(second[2].value == interval_s);
}

}  // namespace flight_gnc_lateral_logic_test
