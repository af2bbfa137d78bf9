// SPDX-License-Identifier: Apache-2.0
// What guidance and navigators believe beside what is so, and what of the vehicle is the scenario's.
#include "simulation/devices/load.hpp"
#include "simulation/entry_flight.hpp"
#include "simulation/entry_reference.hpp"
#include "simulation/initial_state.hpp"
#include "simulation/mars/atmosphere.hpp"
#include "simulation/vehicle/aeroshell.hpp"
#include "simulation/vehicle/engines.hpp"
#include "simulation/vehicle/parachute.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/gnc_venue.hpp"

#include <cmath>
#include <string>
#include <vector>

namespace simulation_believed_test {

using namespace aeolis;
using namespace aeolis::simulation;

namespace {

/// What the truth is, as a belief.
Belief belief_of(const Scenario& scenario) {
    return {scenario.masses,
            scenario.density_scale,
            scenario.aero_scale,
            scenario.parachute_drag_area_m2,
            scenario.steady_wind_east_mps,
            scenario.steady_wind_north_mps};
}

Scenario believing(double start_before_entry_s = 700.0) {
    Scenario scenario = tests::undisturbed_scenario(start_before_entry_s);
    scenario.believed = belief_of(scenario);
    return scenario;
}

bool found(const Scenario& scenario, const std::string& words) {
    for (const std::string& line : impossible_values(scenario))
        if (line.find(words) != std::string::npos) return true;
    return false;
}

double touchdown_mps(const Scenario& scenario) {
    tests::GncVenue venue(scenario, 1);
    venue.run();
    REQUIRE(venue.world().outcome() == Outcome::touchdown);
    return venue.world().touchdown()->vertical_mps;
}

}  // namespace

TEST_CASE("who believes what is so flies as who says nothing of belief", "[simulation][believed]") {
    tests::GncVenue silent(tests::undisturbed_scenario(60.0), 1), believer(believing(60.0), 1);
    while (silent.running() && silent.world().truth().e_s < 120.0) {
        silent.step();
        believer.step();
    }
    CHECK(silent.world().truth().p_MoB_M_m == believer.world().truth().p_MoB_M_m);
    CHECK(silent.told().p_MoB_M_m == believer.told().p_MoB_M_m);
}

TEST_CASE("gravity that is believed a thousandth too strong lands slower, as the flown landing did",
          "[simulation][believed][gnc]") {
    const double as_it_is_mps = touchdown_mps(tests::undisturbed_scenario());
    Scenario scenario = believing();
    scenario.believed->gravity_fraction = 0.001;
    const double believed_mps = touchdown_mps(scenario);
    INFO(as_it_is_mps << " m/s, then " << believed_mps);
    CHECK(believed_mps < as_it_is_mps - 0.01);
    CHECK(believed_mps > as_it_is_mps - 0.2);
    scenario.believed->gravity_fraction = -0.001;
    CHECK(touchdown_mps(scenario) > as_it_is_mps + 0.01);
}

TEST_CASE("masses, air and drag that are believed are guidance's, and the vehicle flies by its own",
          "[simulation][believed]") {
    Scenario scenario = believing();
    Belief& belief = *scenario.believed;
    belief.masses.entry_kg += 60.0;
    belief.masses.heatshield_kg += 60.0;
    belief.density_scale = {{0.0, 0.9}, {100000.0, 0.8}};
    belief.aero_scale = {{0.0, 1.05, 0.95}};
    CHECK(impossible_values(scenario).empty());

    const flight::Load load = load_for(scenario), true_load = load_for(tests::undisturbed_scenario());
    CHECK(load.entry_mass_kg == true_load.entry_mass_kg + 60.0);
    const auto expected = make_entry_reference(as_believed(scenario));
    CHECK(load.entry_reference.rows[20].drag_mps2 == expected.rows[20].drag_mps2);
    CHECK(load.entry_reference.rows[20].drag_mps2 != true_load.entry_reference.rows[20].drag_mps2);

    const World world{scenario, 1, 0}, true_world{tests::undisturbed_scenario(), 1, 0};
    CHECK(world.truth().p_MoB_M_m == true_world.truth().p_MoB_M_m);
    CHECK(as_believed(scenario).masses.entry_kg == belief.masses.entry_kg);
    CHECK_FALSE(as_believed(scenario).believed);
}

TEST_CASE("a position that is believed is off by that much at entry, beside what a case draws",
          "[simulation][believed]") {
    Scenario scenario = tests::gale_scenario(60.0);
    const InitialState before = initial_state(scenario, 3, 5);
    scenario.believed = belief_of(scenario);
    scenario.believed->position_east_m = 3000.0;
    scenario.believed->position_north_m = -500.0;
    scenario.believed->position_up_m = 40.0;
    const InitialState after = initial_state(scenario, 3, 5);
    CHECK(after.truth.p_MoB_M == before.truth.p_MoB_M);
    const auto at_entry = [](const InitialState& at) {
        return coast({vector3(at.solution.p_MoB_M_m), vector3(at.solution.v_MB_M_mps)}, 60.0).p_MoB_M;
    };
    const Vector3 off_M = at_entry(after) - at_entry(before);
    const Horizon local = horizon(at_entry(before));
    CHECK(off_M.dot(local.east) == Approx(3000.0).margin(2.0));
    CHECK(off_M.dot(local.north) == Approx(-500.0).margin(2.0));
    CHECK(off_M.dot(local.up) == Approx(40.0).margin(2.0));
}

TEST_CASE("an attitude that is believed is off by that much in cruise, and is so once when a case is drawn later",
          "[simulation][believed][campaign]") {
    Scenario scenario = believing(61.0);
    scenario.believed->attitude_x_deg = 0.2;
    scenario.believed->position_east_m = 3000.0;
    World world{scenario, 1, 0};
    int told = 0;
    for (int i = 0; i < 64; ++i) {
        const flight::DeviceInputs in = world.sense();
        if (in.cruise_attitude) {
            ++told;
            const auto quaternion = [](const std::array<double, 4>& q) { return Quaternion{q[0], q[1], q[2], q[3]}; };
            const Quaternion cruise = quaternion(in.cruise_attitude->q_MB), truth = quaternion(world.inspect().q_MB);
            CHECK(cruise.angularDistance(truth) == Approx(0.2 * degree_rad).epsilon(1e-3));
        }
        world.advance_uncommanded();
    }
    CHECK(told > 0);
    // What was off before is not added again.
    const flight::NavigationShift shift = world.disperse(1, 1);
    CHECK(vector3(shift.p_MoB_M_m).norm() < 1e-3);
    CHECK(std::abs(shift.q_BB[0]) == Approx(1.0).margin(1e-12));
}

TEST_CASE("a parachute that is fired by range is fired there, in any air, and one by speed is not",
          "[simulation][believed][gnc]") {
    struct Mortar {
        double range_m, speed_mps, mach;
        bool by_range;
    };
    const auto mortar = [](const Scenario& scenario) {
        tests::GncVenue venue(scenario, 1);
        venue.run();
        REQUIRE(venue.world().outcome() == Outcome::touchdown);
        const auto* fired = venue.event(flight::gnc::Trigger::parachute);
        REQUIRE(fired != nullptr);
        bool by_range = false;
        for (const auto& condition : fired->told.triggers[0].conditions)
            by_range = by_range || condition.quantity == flight::Quantity::range_to_go_m;
        return Mortar{fired->told.range_to_go_m, fired->truth.speed_mps, fired->told.mach, by_range};
    };
    // Air that is thinner or denser than believed from 40 km down.
    const auto in_air = [](Scenario scenario, double scale) {
        scenario.believed = belief_of(scenario);
        for (DensityScale& row : scenario.density_scale)
            if (row.altitude_m <= 40000.0) row.scale *= scale;
        return scenario;
    };
    const Scenario by_speed = tests::undisturbed_scenario();
    Scenario by_range = by_speed;
    by_range.parameters.parachute_range_m = 7000.0;
    by_range.parachute_speed_mps = 380.0;
    for (const double scale : {0.96, 1.0, 1.04}) {
        const Mortar speed = mortar(in_air(by_speed, scale)), range = mortar(in_air(by_range, scale));
        INFO("air times " << scale << ": by speed " << speed.range_m << " m and " << speed.speed_mps
                          << " m/s, by range " << range.range_m << " m and " << range.speed_mps << " m/s");
        CHECK_FALSE(speed.by_range);
        CHECK(speed.speed_mps == Approx(405.0).margin(1.0));
        CHECK(range.by_range);
        CHECK(range.range_m < 7000.0);
        CHECK(range.range_m > 7000.0 - 4.0 / 64.0 * range.speed_mps);  // it holds for three cycles
        CHECK(range.speed_mps > 380.0);
        CHECK(range.mach < by_range.parameters.parachute_mach_max);
    }
}

TEST_CASE("the vehicle is loaded with the parameters of its scenario", "[simulation][believed][parameters]") {
    Scenario scenario = tests::undisturbed_scenario();
    scenario.parameters.constant_velocity_mps = 29.0;
    scenario.parameters.sky_crane_descent_rate_mps = 0.65;
    CHECK(load_for(scenario).parameters == scenario.parameters);
    tests::GncVenue venue(scenario, 1);
    double slowest_in_approach_mps = 100.0;
    while (venue.running()) {
        venue.step();
        if (venue.gnc().mode() == flight::gnc::Mode::constant_velocity)
            slowest_in_approach_mps = std::min(slowest_in_approach_mps, venue.told().descent_rate_mps);
    }
    REQUIRE(venue.world().outcome() == Outcome::touchdown);
    CHECK(slowest_in_approach_mps == Approx(29.0).margin(1.0));
    CHECK(venue.world().touchdown()->vertical_mps == Approx(0.65).margin(0.06));
}

TEST_CASE("drag and lift are scaled by Mach number, linear between rows and held outside", "[simulation][believed]") {
    const std::vector<AeroScale> rows{{2.0, 1.1, 0.9}, {10.0, 0.9, 1.0}};
    CHECK(scaled({1.0, 1.0}, rows, 1.0).drag == 1.1);
    CHECK(scaled({1.0, 1.0}, rows, 2.0).lift == 0.9);
    CHECK(scaled({2.0, 1.0}, rows, 6.0).drag == Approx(2.0));
    CHECK(scaled({1.0, 1.0}, rows, 6.0).lift == Approx(0.95));
    CHECK(scaled({1.0, 1.0}, rows, 20.0).drag == 0.9);
    CHECK(scaled({1.3, 0.2}, {}, 6.0).drag == 1.3);

    Scenario scenario = tests::undisturbed_scenario();
    const PointMass at = nominal_entry(scenario);
    const Sensed before = EntryFlight{scenario}.sensed(at);
    scenario.aero_scale = {{0.0, 1.2, 0.8}};
    const Sensed after = EntryFlight{scenario}.sensed(at);
    CHECK(after.drag_mps2 == Approx(1.2 * before.drag_mps2));
    CHECK(after.lift_mps2 == Approx(0.8 * before.lift_mps2));
}

TEST_CASE("a vehicle whose drag is not as guidance believes still lands, and burns the air's energy elsewhere",
          "[simulation][believed][gnc]") {
    Scenario scenario = tests::undisturbed_scenario();
    scenario.aero_scale = {{0.0, 1.06, 1.0}};
    Scenario wrong = scenario;
    wrong.believed = belief_of(tests::undisturbed_scenario());
    for (const Scenario& one : {scenario, wrong}) {
        tests::GncVenue venue(one, 1);
        venue.run();
        REQUIRE(venue.world().outcome() == Outcome::touchdown);
        CHECK(venue.world().touchdown()->vertical_mps == Approx(0.75).margin(0.1));
    }
}

TEST_CASE("engines are as strong as the scenario says, and guidance knows it", "[simulation][engines][believed]") {
    EngineDesign design{3000.0, 300.0, 200.0, 220.0};
    flight::EngineCommand full;
    full.ignited = true;
    full.throttle.fill(1.0);
    Engines engines{design};
    engines.open_valves(0.0);
    engines.command(full, 10.0);
    double burnt_kg = 0.0;
    for (int i = 0; i < 400; ++i) burnt_kg = engines.advance(10.2 + 0.005 * i, 0.005, 387.0);
    CHECK(engines.thrust_N() == Approx(8 * 3000.0));
    CHECK(burnt_kg / 0.005 == Approx(8 * 3000.0 / (220.0 * standard_gravity_mps2)));
    engines.place(full, 0.0);
    CHECK(engines.thrust_N() == Approx(8 * 3000.0));

    Scenario scenario = tests::undisturbed_scenario();
    scenario.engines = design;
    scenario.guidance = {250.0, 90.0, 0.22, 207.0};
    const flight::Load load = load_for(scenario);
    CHECK(load.engine_max_thrust_N == 3000.0);
    CHECK(load.engine_min_thrust_N == 300.0);
    CHECK(load.engine_isp_s == 207.0);
    CHECK(load.divert_m == 250.0);
    CHECK(load.divert_azimuth_deg == 90.0);
    CHECK(load.entry_lift_to_drag == 0.22);
}

TEST_CASE("the sidestep is as long as the scenario says", "[simulation][believed][gnc]") {
    const auto sidestep_m = [](double divert_m) {
        Scenario scenario = tests::undisturbed_scenario();
        scenario.guidance.divert_m = divert_m;
        tests::GncVenue venue(scenario, 1);
        venue.run();
        REQUIRE(venue.world().outcome() == Outcome::touchdown);
        const auto* from = venue.event(flight::gnc::Trigger::powered_approach);
        REQUIRE(from != nullptr);
        const Vector3 begin = vector3(from->truth.p_MoB_M_m), end = vector3(venue.world().truth().p_MoB_M_m);
        const Horizon local = horizon(begin);
        const double azimuth_rad = scenario.guidance.divert_azimuth_deg * degree_rad;
        return std::abs((end - begin).dot(std::sin(azimuth_rad) * local.east + std::cos(azimuth_rad) * local.north));
    };
    CHECK(std::abs(sidestep_m(360.0) - sidestep_m(304.0)) == Approx(56.0).margin(12.0));
}

TEST_CASE("beliefs and vehicles that cannot be are named", "[simulation][scenario][believed]") {
    Scenario scenario = believing();
    CHECK(impossible_values(scenario).empty());
    scenario.believed->masses.entry_kg += 60.0;
    CHECK(found(scenario, "believed.masses.entry_kg: 3213 is not the sum of its parts"));
    scenario = believing();
    scenario.believed->gravity_fraction = 0.5;
    CHECK(found(scenario, "believed.gravity_fraction: 0.5 is outside -0.01 … 0.01"));
    scenario.believed->gravity_fraction = std::nan("");
    CHECK(found(scenario, "believed.gravity_fraction"));
    scenario = believing();
    scenario.believed->density_scale = {{0.0, 50.0}};
    CHECK(found(scenario, "believed.density_scale[0].scale: 50 is outside"));
    scenario = believing();
    scenario.aero_scale = {{5.0, 1.0, 1.0}, {4.0, 1.0, 9.0}};
    CHECK(found(scenario, "aero_scale[1].lift: 9 is outside 0.1 … 3"));
    CHECK(found(scenario, "aero_scale[1].mach: 4 does not lie above the one before"));
    scenario = believing();
    scenario.engines.least_thrust_N = 4000.0;
    CHECK(found(scenario, "engines.least_thrust_N: 4000 is outside"));
    scenario.engines.most_impulse_s = 100.0;
    CHECK(found(scenario, "engines.most_impulse_s: 100 is outside"));
}

TEST_CASE("the departure of the air grows from 50 km to what it is aloft", "[simulation][atmosphere]") {
    Dispersions dispersions{};
    dispersions.density_fraction = 0.04;
    const Atmosphere usual{{}, {}, dispersions, Random{1, 3, Stream::density}};
    dispersions.density_aloft_fraction = 0.2;
    const Atmosphere grown{{}, {}, dispersions, Random{1, 3, Stream::density}};
    const Atmosphere plain{{}};
    const auto departure = [&](const Atmosphere& air, double altitude_m) {
        return air.at(altitude_m).density_kgm3 / plain.at(altitude_m).density_kgm3 - 1.0;
    };
    CHECK(departure(grown, 30'000.0) == departure(usual, 30'000.0));
    CHECK(departure(grown, 50'000.0) == Approx(departure(usual, 50'000.0)));
    CHECK(departure(grown, 57'500.0) == Approx(3.0 * departure(usual, 57'500.0)));
    CHECK(departure(grown, 65'000.0) == Approx(5.0 * departure(usual, 65'000.0)));
    CHECK(departure(grown, 110'000.0) == Approx(5.0 * departure(usual, 110'000.0)));
    CHECK(departure(usual, 65'000.0) != 0.0);
    dispersions.density_fraction = 0.0;  // the air aloft alone
    const Atmosphere alone{{}, {}, dispersions, Random{1, 3, Stream::density}};
    CHECK(departure(alone, 30'000.0) == 0.0);
    CHECK(departure(alone, 80'000.0) == Approx(departure(grown, 80'000.0)));
}

TEST_CASE("the departure of the air has the deviation that its scale has by height", "[simulation][atmosphere]") {
    Dispersions dispersions{};
    dispersions.density_fraction = 0.04;
    const std::vector<DensityScale> rows{{0.0, 1.1, 0.02}, {40'000.0, 1.1, 0.02}, {60'000.0, 1.0, 0.12}};
    const Atmosphere usual{{}, {}, dispersions, Random{1, 3, Stream::density}};
    const Atmosphere by_height{rows, {}, dispersions, Random{1, 3, Stream::density}};
    const Atmosphere plain{{}}, scaled_alone{rows};
    const auto departure = [](const Atmosphere& air, const Atmosphere& from, double altitude_m) {
        return air.at(altitude_m).density_kgm3 / from.at(altitude_m).density_kgm3 - 1.0;
    };
    for (const auto& [altitude_m, deviation] :
         {std::pair{-1000.0, 0.02}, {30'000.0, 0.02}, {50'000.0, 0.07}, {60'000.0, 0.12}, {110'000.0, 0.12}})
        CHECK(departure(by_height, scaled_alone, altitude_m) ==
              Approx(deviation / 0.04 * departure(usual, plain, altitude_m)));
    CHECK(by_height.departure_fraction() == Approx(0.5 * usual.departure_fraction()));
    CHECK(departure(scaled_alone, plain, 30'000.0) == Approx(0.1));

    Scenario scenario = tests::gale_scenario(60.0);
    scenario.density_scale = rows;
    scenario.believed = belief_of(scenario);
    const auto joined = with_deviations_of(std::vector<DensityScale>{{10'000.0, 0.9}}, rows);
    REQUIRE(joined.size() == 4);
    CHECK(joined[1].scale == 0.9);
    CHECK(joined[1].deviation == 0.02);
    CHECK(joined[3].scale == 0.9);
    CHECK(joined[3].deviation == 0.12);
    CHECK(with_deviations_of({}, rows)[2].scale == 1.0);
    const std::vector<DensityScale> plain_rows{{0.0, 1.1}, {9'000.0, 0.7}};
    CHECK(with_deviations_of(plain_rows, plain_rows).size() == 2);  // as it is, to the last bit
    CHECK(with_deviations_of({}, plain_rows).empty());
    const Scenario nominal = as_believed(undispersed(scenario));
    for (const DensityScale& row : nominal.density_scale) CHECK(row.deviation == 0.0);
    scenario.density_scale[1].deviation = 0.6;
    CHECK(found(scenario, "density_scale[1].deviation: 0.6 is outside 0 … 0.5"));
}

TEST_CASE("the parachute's area swings above Mach 1.4 alone, two times a second", "[simulation][parachute]") {
    const ParachuteOscillation swing{0.1, 0.0};
    CHECK(swing.factor(1.3, 2.125) == 1.0);
    CHECK(swing.factor(1.6, 2.125) == Approx(1.1));
    CHECK(swing.factor(1.6, 2.375) == Approx(0.9));
    CHECK(swing.factor(1.6, 2.625) == Approx(1.1));
    CHECK(ParachuteOscillation{}.factor(1.6, 2.125) == 1.0);
}

}  // namespace simulation_believed_test
