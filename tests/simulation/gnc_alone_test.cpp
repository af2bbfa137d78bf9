// SPDX-License-Identifier: Apache-2.0
#include "tests/simulation/gale.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/gnc_venue.hpp"

#include <cmath>

namespace simulation_gnc_alone_test {

using namespace aeolis;
using namespace aeolis::flight::gnc;

namespace {

simulation::Scenario without_errors() {
    return tests::undisturbed_scenario();
}

void check_soft_landing(const simulation::World& world, double miss_max_m) {
    REQUIRE(world.outcome() == simulation::Outcome::touchdown);
    REQUIRE(world.touchdown());
    CHECK(world.touchdown()->vertical_mps == Approx(0.75).margin(0.1));
    CHECK(world.touchdown()->horizontal_mps <= 0.5);
    CHECK(world.touchdown()->miss_m < miss_max_m);
}

struct Near {
    Trigger trigger;
    double e_s, within_s;
    double altitude_m, within_m;
    double speed_mps, within_mps;
};

}  // namespace

TEST_CASE("GNC alone lands the published case, and near its published times", "[gnc][R27]") {
    tests::GncVenue venue(without_errors(), 1);
    venue.run();

    check_soft_landing(venue.world(), 1000.0);
    CHECK(venue.world().peak_deceleration_mps2() > 11.0 * 9.80665);
    CHECK(venue.world().peak_deceleration_mps2() < 13.0 * 9.80665);

    // OD137, [facts] Timeline; altitudes of the stage above the landing radius, its height at touchdown added.
    const Near published[] = {
        {Trigger::guidance_start, 43.0, 3.0, 67100, 3000, 5872, 10},
        {Trigger::heading_alignment, 137.0, 5.0, 17960, 1500, 1100, 5},
        {Trigger::sufr_start, 239.0, 5.0, 14100, 1500, 453, 5},
        {Trigger::parachute, 255.9, 5.0, 11900, 1200, 404.6, 2},
        {Trigger::heatshield, 277.35, 6.0, 9890, 400, 142, 2},
        {Trigger::backshell, 374.97, 5.0, 1662, 40, 79.1, 2},
        {Trigger::powered_approach, 378.2, 5.0, 1388, 40, 90.5, 2},
        {Trigger::constant_velocity, 396.8, 5.0, 243, 10, 32.0, 1},
        {Trigger::constant_deceleration, 400.0, 5.0, 146, 10, 32.0, 1},
        {Trigger::sky_crane, 407.3, 5.0, 26.5, 3, 0.75, 0.3},
        {Trigger::touchdown, 431.47, 5.0, 8.5, 2, 0.75, 0.3},
    };
    for (const Near& near : published) {
        INFO("trigger " << static_cast<int>(near.trigger));
        const auto* event = venue.event(near.trigger);
        REQUIRE(event != nullptr);
        CHECK(event->truth.e_s == Approx(near.e_s).margin(near.within_s));
        CHECK(event->truth.altitude_m == Approx(near.altitude_m).margin(near.within_m));
        CHECK(event->truth.speed_mps == Approx(near.speed_mps).margin(near.within_mps));
    }
    CHECK(venue.told().reversals == 3);
}

TEST_CASE("with perfect sensors navigation stays with the truth", "[gnc][R27]") {
    tests::GncVenue venue(without_errors(), 1);
    venue.run();
    for (const auto& event : venue.events()) {
        CHECK(std::abs(event.told.altitude_m - event.truth.altitude_m) < 15.0);
        CHECK(std::abs(event.told.speed_mps - event.truth.speed_mps) < 0.7);
    }
}

TEST_CASE("what GNC cannot know does not change what it does: only its inputs do", "[gnc][R27]") {
    tests::GncVenue one(tests::gale_scenario(), 5), two(tests::gale_scenario(), 5);
    one.run();
    two.run();
    CHECK(one.told().p_MoB_M_m == two.told().p_MoB_M_m);
    CHECK(one.told().mass_kg == two.told().mass_kg);
}

namespace {

void check_landings(std::uint64_t cases) {
    for (std::uint64_t number = 1; number <= cases; ++number) {
        INFO("case " << number);
        tests::GncVenue venue(tests::gale_scenario(), 1, number);
        venue.run();
        check_soft_landing(venue.world(), 10000.0);  // [facts]: 99 % ellipse 20 km long
        const auto* parachute = venue.event(Trigger::parachute);
        REQUIRE(parachute != nullptr);
        CHECK(parachute->seen.mach > 1.4);
        CHECK(parachute->seen.mach < 2.2);
        CHECK(parachute->seen.dynamic_pressure_Pa > 200.0);
        CHECK(parachute->seen.dynamic_pressure_Pa < 750.0);
        CHECK(venue.world().inspect().propellant_kg > 0.0);
    }
}

}  // namespace

TEST_CASE("dispersed cases all land, softly and with the parachute in its box", "[gnc][R27]") {
    check_landings(5);
}

TEST_CASE("two hundred dispersed cases do", "[.long][gnc][R27]") {
    check_landings(200);
}

TEST_CASE("each change of configuration changes what GNC controls with: none, rates, bank, hanging, thrust",
          "[gnc][R26]") {
    using Attitude = AttitudeCommand::Mode;
    tests::GncVenue venue(without_errors(), 1);
    std::vector<Attitude> modes{Attitude::idle};
    bool throttled_before_priming = false, engines_and_thrusters = false;
    while (venue.running()) {
        venue.step();
        const Output& told = venue.told();
        if (told.attitude.mode != modes.back()) modes.push_back(told.attitude.mode);
        throttled_before_priming |= !venue.configuration().engines_primed && told.engines.ignited;
        engines_and_thrusters |=
            told.mode > Mode::free_fall && told.engines.ignited && told.thrusters != flight::ThrusterCommand{};
    }
    CHECK(modes ==
          std::vector{Attitude::idle, Attitude::detumble, Attitude::entry_bank, Attitude::suspended, Attitude::thrust});
    CHECK_FALSE(throttled_before_priming);
    CHECK_FALSE(engines_and_thrusters);
}

}  // namespace simulation_gnc_alone_test
