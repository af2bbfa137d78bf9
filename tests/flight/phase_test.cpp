#include "flight/edl/phase.hpp"

#include "tests/support/catch.hpp"

using namespace aeolis::flight;

TEST_CASE("the phase follows GNC's mode, and before GNC the clock", "[edl]") {
    gnc::Configuration configuration;
    CHECK(phase_of(gnc::Mode::off, configuration, false) == EdlPhase::pre_edl);
    CHECK(phase_of(gnc::Mode::off, configuration, true) == EdlPhase::late_cruise);
    configuration.cruise_stage_gone = true;
    CHECK(phase_of(gnc::Mode::off, configuration, true) == EdlPhase::exo_atmospheric);
    CHECK(phase_of(gnc::Mode::range_control, configuration, true) == EdlPhase::range_control);
    CHECK(phase_of(gnc::Mode::constant_velocity, configuration, true) == EdlPhase::powered_descent);
}

TEST_CASE("the vehicle has landed when its stage has flown away, not before", "[edl]") {
    gnc::Configuration configuration;
    CHECK(phase_of(gnc::Mode::flyaway, configuration, true) == EdlPhase::flyaway);
    configuration.engines_off = true;
    CHECK(phase_of(gnc::Mode::flyaway, configuration, true) == EdlPhase::landed);
}
