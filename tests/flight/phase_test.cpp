// SPDX-License-Identifier: Apache-2.0
#include "flight/edl/phase.hpp"

#include "tests/support/catch.hpp"

#include <utility>
#include <vector>

namespace flight_phase_test {

using namespace aeolis::flight;

namespace {

constexpr Approach late_cruise{.late_cruise = true}, begun{.late_cruise = true, .begun = true},
    all_over{.late_cruise = true, .begun = true, .pre_edl_over = true};

}  // namespace

TEST_CASE("the phase follows GNC's mode, and before GNC do edl and the clock", "[edl][R23][R48]") {
    gnc::Configuration configuration;
    Phase phase;
    CHECK(phase.state() == EdlPhase::pre_edl);
    CHECK(phase.follow(gnc::Mode::off, configuration, late_cruise).size() == 1);
    CHECK(phase.state() == EdlPhase::late_cruise);
    CHECK(phase.follow(gnc::Mode::off, configuration, {}).size() == 1);  // a newer solution puts entry later
    CHECK(phase.state() == EdlPhase::pre_edl);
    CHECK(phase.follow(gnc::Mode::off, configuration, {}).empty());
    CHECK(phase.follow(gnc::Mode::off, configuration, begun).size() == 2);
    CHECK(phase.state() == EdlPhase::edl_approach);
    CHECK(phase.follow(gnc::Mode::off, configuration, {.begun = true}).empty());  // begun is begun
    CHECK(phase.follow(gnc::Mode::off, configuration, all_over).size() == 1);
    CHECK(phase.state() == EdlPhase::edl_main);
    configuration.cruise_stage_gone = true;
    CHECK(phase.follow(gnc::Mode::off, configuration, all_over).size() == 1);
    CHECK(phase.state() == EdlPhase::exo_atmospheric);
    using gnc::Mode;
    const std::vector<std::pair<Mode, EdlPhase>> landing{
        {Mode::approach, EdlPhase::exo_atmospheric},
        {Mode::wait_for_guidance_start, EdlPhase::wait_for_guidance},
        {Mode::range_control, EdlPhase::range_control},
        {Mode::heading_alignment, EdlPhase::heading_alignment},
        {Mode::straighten_up, EdlPhase::straighten_up},
        {Mode::wait_for_parachute, EdlPhase::wait_for_parachute},
        {Mode::parachute_descent, EdlPhase::parachute_descent},
        {Mode::free_fall, EdlPhase::powered_descent},
        {Mode::powered_approach, EdlPhase::powered_descent},
        {Mode::constant_velocity, EdlPhase::powered_descent},
        {Mode::constant_deceleration, EdlPhase::powered_descent},
        {Mode::sky_crane, EdlPhase::sky_crane},
        {Mode::touchdown, EdlPhase::flyaway},
        {Mode::flyaway, EdlPhase::flyaway},
    };
    for (const auto& [mode, expected] : landing) {
        const bool changes = expected != phase.state();
        CHECK(!phase.follow(mode, configuration, all_over).empty() == changes);
        CHECK(phase.state() == expected);
    }
}

TEST_CASE("do edl in the last hours begins the approach and the main part of EDL at once", "[edl]") {
    Phase phase;
    CHECK(phase.follow(gnc::Mode::off, {}, all_over).size() == 3);
    CHECK(phase.state() == EdlPhase::edl_main);
}

TEST_CASE("the vehicle has landed when its stage has flown away, not before", "[edl]") {
    gnc::Configuration configuration;
    configuration.cruise_stage_gone = true;
    Phase phase;
    for (const auto mode :
         {gnc::Mode::approach, gnc::Mode::wait_for_guidance_start, gnc::Mode::range_control,
          gnc::Mode::parachute_descent, gnc::Mode::free_fall, gnc::Mode::sky_crane, gnc::Mode::flyaway})
        phase.follow(mode, configuration, all_over);
    CHECK(phase.state() == EdlPhase::flyaway);
    configuration.engines_off = true;
    CHECK(phase.follow(gnc::Mode::flyaway, configuration, all_over).size() == 1);
    CHECK(phase.state() == EdlPhase::landed);
}

TEST_CASE("what the table of phases does not have does not happen", "[edl][R48]") {
    gnc::Configuration configuration;
    Phase phase;
    CHECK(phase.follow(gnc::Mode::sky_crane, configuration, {}).empty());
    CHECK(phase.state() == EdlPhase::pre_edl);
}

}  // namespace flight_phase_test
