// SPDX-License-Identifier: Apache-2.0
#include "flight/edl/phase.hpp"

#include "tests/support/catch.hpp"

#include <utility>
#include <vector>

namespace flight_phase_test {

using namespace aeolis::flight;

TEST_CASE("the phase follows GNC's mode, and before GNC the clock", "[edl][R48]") {
    gnc::Configuration configuration;
    Phase phase;
    CHECK(phase.state() == EdlPhase::pre_edl);
    CHECK(phase.follow(gnc::Mode::off, configuration, true).size() == 1);
    CHECK(phase.state() == EdlPhase::late_cruise);
    CHECK(phase.follow(gnc::Mode::off, configuration, false).size() == 1);  // a newer solution puts entry later
    CHECK(phase.state() == EdlPhase::pre_edl);
    CHECK(phase.follow(gnc::Mode::off, configuration, false).empty());
    configuration.cruise_stage_gone = true;
    CHECK(phase.follow(gnc::Mode::off, configuration, true).size() == 2);  // late cruise, and out of it at once
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
        CHECK(!phase.follow(mode, configuration, true).empty() == changes);
        CHECK(phase.state() == expected);
    }
}

TEST_CASE("the vehicle has landed when its stage has flown away, not before", "[edl]") {
    gnc::Configuration configuration;
    configuration.cruise_stage_gone = true;
    Phase phase;
    for (const auto mode :
         {gnc::Mode::approach, gnc::Mode::wait_for_guidance_start, gnc::Mode::range_control,
          gnc::Mode::parachute_descent, gnc::Mode::free_fall, gnc::Mode::sky_crane, gnc::Mode::flyaway})
        phase.follow(mode, configuration, true);
    CHECK(phase.state() == EdlPhase::flyaway);
    configuration.engines_off = true;
    CHECK(phase.follow(gnc::Mode::flyaway, configuration, true).size() == 1);
    CHECK(phase.state() == EdlPhase::landed);
}

TEST_CASE("what the table of phases does not have does not happen", "[edl][R48]") {
    gnc::Configuration configuration;
    Phase phase;
    CHECK(phase.follow(gnc::Mode::sky_crane, configuration, false).empty());
    CHECK(phase.state() == EdlPhase::pre_edl);
}

}  // namespace flight_phase_test
