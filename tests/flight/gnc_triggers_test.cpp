// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/powered_descent/vertical_profile.hpp"
#include "flight/gnc/triggers/triggers.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <string>

namespace flight_gnc_triggers_test {

using namespace aeolis::flight::gnc;
using namespace aeolis::flight::gnc::triggers;
constexpr aeolis::flight::Parameters parameters;

namespace {

constexpr ParachuteBounds bounds{405.0, 6000.0};
constexpr BackshellBounds design{1660.0, 79.1};

}  // namespace

TEST_CASE("entry guidance starts at 0.2 g of drag", "[gnc][R17]") {
    CHECK_FALSE(all_hold(guidance_start(parameters, 1.95)));
    CHECK(all_hold(guidance_start(parameters, 1.96)));
}

TEST_CASE("the parachute needs the speed and three cycles of it", "[gnc][R17]") {
    CHECK_FALSE(all_hold(parachute(parameters, {405.1, 12000.0, 110.0}, bounds, 3)));
    CHECK_FALSE(all_hold(parachute(parameters, {404.9, 12000.0, 110.0}, bounds, 2)));
    CHECK(all_hold(parachute(parameters, {404.9, 12000.0, 110.0}, bounds, 3)));
    CHECK(parachute(parameters, {404.9, 12000.0, 110.0}, bounds, 3).size() == 4);
}

TEST_CASE("below its lowest altitude the parachute waits for its speed no longer", "[gnc][R17][R48]") {
    CHECK_FALSE(parachute_due(parameters, {500.0, 6000.1, 150.0}, bounds));
    CHECK(parachute_due(parameters, {500.0, 6000.0, 150.0}, bounds));
    CHECK(parachute_due(parameters, {405.0, 12000.0, 110.0}, bounds));
    const auto low = parachute(parameters, {500.0, 6000.0, 150.0}, bounds, 3);
    CHECK(all_hold(low));
    CHECK(low[0].quantity == aeolis::flight::Quantity::altitude_m);  // and says why
    CHECK_FALSE(all_hold(parachute(parameters, {500.0, 6000.0, 150.0}, bounds, 2)));
}

TEST_CASE("a parachute by range is fired there, and at its lowest speed at the latest", "[gnc][R17]") {
    aeolis::flight::Parameters by_range;
    by_range.parachute_range_m = 8000.0;
    const InAir near{450.0, 9000.0, 110.0, 600.0, 2.0, 7999.0}, far{450.0, 9000.0, 110.0, 600.0, 2.0, 8001.0};
    CHECK(parachute_due(by_range, near, bounds));
    CHECK_FALSE(parachute_due(by_range, far, bounds));
    CHECK_FALSE(parachute_due(parameters, near, bounds));
    CHECK_FALSE(all_hold(parachute(by_range, near, bounds, 2)));
    const auto fired = parachute(by_range, near, bounds, 3), awaited = parachute(by_range, far, bounds, 0);
    CHECK(all_hold(fired));
    CHECK(fired[0].quantity == Quantity::range_to_go_m);
    CHECK(awaited[0].quantity == Quantity::range_to_go_m);
    CHECK(parachute_due(by_range, {405.0, 9000.0, 110.0, 600.0, 1.8, 20000.0}, bounds));
    CHECK(parachute_due(by_range, {450.0, 6000.0, 110.0, 600.0, 2.0, 20000.0}, bounds));
    CHECK_FALSE(parachute_due(by_range, {470.0, 9000.0, 110.0, 600.0, 2.16, 7000.0}, bounds));  // Mach number
    CHECK_FALSE(parachute_due(by_range, {450.0, 9000.0, 110.0, 721.0, 2.0, 7000.0}, bounds));   // pressure
}

TEST_CASE("straightening up begins its lead time before the parachute's range", "[gnc][R17]") {
    aeolis::flight::Parameters by_range;
    by_range.parachute_range_m = 8000.0;
    constexpr double lead_m = 18.0 * 480.0;  // level at 500 m/s with 140 m/s of descent
    CHECK(all_hold(sufr_start(by_range, {500.0, 12000.0, 140.0, 600.0, 2.1, 8000.0 + lead_m - 1.0}, 2.8, bounds)));
    CHECK_FALSE(
        all_hold(sufr_start(by_range, {500.0, 12000.0, 140.0, 600.0, 2.1, 8000.0 + lead_m + 1.0}, 1.0, bounds)));
    CHECK_FALSE(all_hold(sufr_start(by_range, {700.0, 14000.0, 140.0, 600.0, 2.8, 9000.0}, 2.8, bounds)));
    CHECK_FALSE(all_hold(sufr_start(parameters, {500.0, 12000.0, 140.0, 600.0, 2.1, 9000.0}, 1.0, bounds)));
}

TEST_CASE("slow or low, the parachute waits until its Mach number and pressure are what it is made for",
          "[gnc][R17][R27]") {
    const double pressure_Pa = parameters.parachute_pressure_max_Pa;
    CHECK(parachute_due(parameters, {404.0, 8000.0, 110.0, pressure_Pa, 1.8}, bounds));
    CHECK_FALSE(parachute_due(parameters, {404.0, 8000.0, 110.0, pressure_Pa + 1.0, 1.8}, bounds));
    CHECK_FALSE(parachute_due(parameters, {520.0, 5900.0, 110.0, 700.0, 2.3}, bounds));
    CHECK(parachute_due(parameters, {480.0, 5900.0, 110.0, 700.0, 2.1}, bounds));
    // Now or never.
    const double last_m = parameters.parachute_altitude_last_m;
    CHECK_FALSE(parachute_due(parameters, {520.0, last_m + 1.0, 110.0, 1500.0, 2.3}, bounds));
    CHECK(parachute_due(parameters, {520.0, last_m, 110.0, 1500.0, 2.3}, bounds));
}

TEST_CASE("straightening up begins its lead time before the parachute's lowest altitude, unless it is too fast",
          "[gnc][R17][R48]") {
    CHECK_FALSE(all_hold(sufr_start(parameters, {600.0, 6000.0 + 18.1 * 150.0, 150.0}, 2.8, bounds)));
    CHECK(all_hold(sufr_start(parameters, {600.0, 6000.0 + 17.9 * 150.0, 150.0}, 2.8, bounds)));
    CHECK_FALSE(all_hold(sufr_start(parameters, {600.0, 5000.0, -10.0}, 2.8, bounds)));  // it climbs
    CHECK_FALSE(all_hold(
        sufr_start(parameters, {2000.0, 20000.0, 900.0}, 60.0, bounds)));  // it dives, and has its lift to pull out
    CHECK(all_hold(sufr_start(parameters, {2000.0, 4500.0, 100.0}, 60.0, bounds)));  // now or never
}

TEST_CASE("the descent rate that ground expects at the backshell moves the altitude at which it goes",
          "[gnc][R17][R48]") {
    // Faster than expected by 2.1 m/s needs more room than faster by 1 m/s.
    CHECK(backshell_altitude_needed_m(parameters, {1660.0, 78.0}, 80.1) >
          backshell_altitude_needed_m(parameters, {1660.0, 79.1}, 80.1));
    CHECK(backshell_altitude_needed_m(parameters, {1660.0, 80.1}, 80.1) == Approx(1660.0));
}

TEST_CASE("a decision that has alternatives is held by all of them, and is made by one", "[gnc][R38]") {
    const auto quantities = [](const Conditions& conditions) {
        std::string all;
        for (const auto& condition : conditions)
            all +=
                std::string(condition.holds ? "+" : "-") + std::to_string(static_cast<int>(condition.quantity)) + " ";
        return all;
    };
    const auto number = [](Quantity quantity) { return std::to_string(static_cast<int>(quantity)) + " "; };
    const double end_m = powered_descent::approach_end_altitude_m(parameters);
    const std::string rate = number(Quantity::descent_rate_mps), altitude = number(Quantity::altitude_m);
    CHECK(quantities(constant_velocity(parameters, end_m + 10.0, 33.6)) == "-" + rate + "-" + altitude);
    CHECK(quantities(constant_velocity(parameters, end_m - 0.1, 33.6)) == "+" + altitude);
    CHECK(quantities(constant_velocity(parameters, end_m + 10.0, 31.9)) == "+" + rate);
}

TEST_CASE("a decision is near when its subject holds or is within a twentieth of its bound", "[gnc][R38]") {
    CHECK(near(parameters, parachute(parameters, {407.1, 12000.0, 110.0}, bounds, 0)));
    CHECK(near(parameters, parachute(parameters, {425.0, 12000.0, 110.0}, bounds, 0)));
    CHECK_FALSE(near(parameters, parachute(parameters, {426.0, 12000.0, 110.0}, bounds, 0)));
    CHECK(near(parameters, heatshield(parameters, {120.0, 9000.0, 90.0}, 142.0, 12.0)));
    CHECK_FALSE(near(parameters, heatshield(parameters, {200.0, 9000.0, 90.0}, 142.0,
                                            25.0)));  // the speed is its subject, not the time
    // Nor is the patience far from its end; near its end it is told, and so is the altitude.
    CHECK(
        near(parameters, heatshield(parameters, {200.0, 9000.0, 90.0}, 142.0, parameters.heatshield_patience_s - 1.0)));
    CHECK(near(parameters,
               heatshield(parameters, {200.0, parameters.heatshield_altitude_min_m + 50.0, 90.0}, 142.0, 25.0)));
    CHECK_FALSE(near(parameters, {}));
    Conditions timer;
    timer.push_back(at_least(Quantity::time_in_mode_s, 3.15, 3.2));
    CHECK_FALSE(near(parameters, timer));
}

TEST_CASE("a count of cycles that has not begun is not worth telling", "[gnc][R38]") {
    const auto tells_count = [](const InAir& at, std::uint32_t cycles) {
        const auto told = worth_telling(parachute(parameters, at, bounds, cycles));
        return std::ranges::find(told, Quantity::cycles_true, &Condition::quantity) != told.end();
    };
    CHECK_FALSE(tells_count({407.1, 12000.0, 110.0}, 0));
    CHECK_FALSE(tells_count({404.9, 12000.0, 110.0}, 0));
    CHECK(tells_count({404.9, 12000.0, 110.0}, 1));
}

TEST_CASE("a break starts the count of cycles anew", "[gnc][R17]") {
    Persistence persistence;
    CHECK(persistence.on(true) == 1);
    CHECK(persistence.on(true) == 2);
    CHECK(persistence.on(false) == 0);
    CHECK(persistence.on(true) == 1);
}

TEST_CASE("straightening up begins its lead time before the parachute's speed", "[gnc][R17]") {
    // OD137: 453 m/s at E+239, slowing at 2.8 m/s² [facts]
    CHECK(all_hold(sufr_start(parameters, {453.0, 14000.0, 120.0}, 2.8, bounds)));
    CHECK_FALSE(all_hold(sufr_start(parameters, {460.0, 14000.0, 120.0}, 2.8, bounds)));
    CHECK_FALSE(all_hold(sufr_start(parameters, {453.0, 14000.0, 120.0}, -1.0, bounds)));  // it gains speed
    CHECK_FALSE(all_hold(
        sufr_start(parameters, {600.0, 14000.0, 120.0}, 100.0, bounds)));  // far above a straight line means nothing
}

TEST_CASE("the heatshield stays on for twenty seconds after the mortar", "[gnc][R17]") {
    CHECK_FALSE(all_hold(heatshield(parameters, {120.0, 9000.0, 90.0}, 142.0, 19.9)));
    CHECK_FALSE(all_hold(heatshield(parameters, {143.0, 9000.0, 90.0}, 142.0, 25.0)));
    CHECK(all_hold(heatshield(parameters, {142.0, 9000.0, 90.0}, 142.0, 20.0)));
}

TEST_CASE("too low or too long after the mortar the heatshield waits for its speed no longer", "[gnc][R17][R27]") {
    const double low_m = parameters.heatshield_altitude_min_m;
    const double late_s = parameters.heatshield_patience_s;
    CHECK_FALSE(all_hold(heatshield(parameters, {160.0, low_m + 1.0, 90.0}, 142.0, 25.0)));
    const auto low = heatshield(parameters, {160.0, low_m, 90.0}, 142.0, 20.0);
    CHECK(all_hold(low));
    CHECK(low[0].quantity == aeolis::flight::Quantity::altitude_m);
    CHECK_FALSE(
        all_hold(heatshield(parameters, {160.0, low_m, 90.0}, 142.0, 19.9)));  // the parachute has hardly opened
    CHECK_FALSE(all_hold(heatshield(parameters, {160.0, 9000.0, 90.0}, 142.0, late_s - 0.1)));
    const auto late = heatshield(parameters, {160.0, 9000.0, 90.0}, 142.0, late_s);
    CHECK(all_hold(late));
    CHECK(late[0].quantity == aeolis::flight::Quantity::time_since_parachute_s);
}

TEST_CASE("the backshell goes at ground's altitude at 79.1 m/s, earlier when faster", "[gnc][R17]") {
    CHECK(backshell_altitude_needed_m(parameters, design, 79.1) == Approx(1660.0));
    CHECK(backshell_altitude_needed_m(parameters, design, 80.1) - 1660.0 == Approx(31.6).epsilon(0.02));
    CHECK_FALSE(all_hold(backshell(parameters, 1661.0, 79.1, design, 3)));
    CHECK_FALSE(all_hold(backshell(parameters, 1659.0, 79.1, design, 2)));
    CHECK(all_hold(backshell(parameters, 1659.0, 79.1, design, 3)));
}

TEST_CASE("engines are primed a quarter of a minute before the backshell goes", "[gnc][R17]") {
    CHECK(all_hold(engine_priming(parameters, 1660.0 + 82.0 * 15.4, 82.0, 1660.0)));
    CHECK_FALSE(all_hold(engine_priming(parameters, 1660.0 + 82.0 * 15.6, 82.0, 1660.0)));
    CHECK_FALSE(all_hold(engine_priming(parameters, 1000.0, -3.0, 1660.0)));  // it climbs
}

}  // namespace flight_gnc_triggers_test
