// SPDX-License-Identifier: Apache-2.0
#include "simulation/initial_state.hpp"
#include "simulation/vectors.hpp"
#include "simulation/world.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/support/catch.hpp"

#include <cmath>
#include <functional>

namespace simulation_dispersion_test {

using namespace aeolis;
using namespace aeolis::simulation;

namespace {

/// Dispersed 60 s before entry, one second after its start.
Scenario dispersed_later() {
    Scenario scenario = tests::gale_scenario(61.0);
    scenario.disperse_before_entry_s = 60.0;
    return scenario;
}

World flown_to_dispersion(std::uint64_t case_number) {
    World world{dispersed_later(), 1, case_number};
    for (int i = 0; i < 64; ++i) {
        world.sense();
        world.advance_uncommanded();
    }
    return world;
}

double deviation(int cases, const std::function<double(std::uint64_t)>& value) {
    double sum = 0.0, squares = 0.0;
    for (int i = 1; i <= cases; ++i) {
        const double x = value(static_cast<std::uint64_t>(i));
        sum += x;
        squares += x * x;
    }
    return std::sqrt((squares - sum * sum / cases) / (cases - 1));
}

}  // namespace

TEST_CASE("before the moment of dispersion nothing of a case shows", "[simulation][campaign]") {
    World one = flown_to_dispersion(1), two = flown_to_dispersion(2);
    CHECK(one.truth().p_MoB_M_m == two.truth().p_MoB_M_m);
    CHECK(one.solution().p_MoB_M_m == two.solution().p_MoB_M_m);
    // What ground believes is the truth: nothing is dispersed yet.
    const auto nominal = coast({vector3(one.solution().p_MoB_M_m), vector3(one.solution().v_MB_M_mps)}, 1.0);
    CHECK((nominal.p_MoB_M - vector3(one.truth().p_MoB_M_m)).norm() < 0.01);
    (void)one.disperse(1, 1);
    (void)two.disperse(1, 2);
    CHECK(one.truth().p_MoB_M_m != two.truth().p_MoB_M_m);
}

TEST_CASE("a case dispersed later is where the same case dispersed at the start is, and so is what ground knows of it",
          "[simulation][campaign]") {
    const World trunk = flown_to_dispersion(0);
    Scenario at_once = dispersed_later();
    at_once.disperse_before_entry_s.reset();
    for (const std::uint64_t number : {1, 5, 12}) {
        World late{trunk};
        const flight::NavigationShift shift = late.disperse(1, number);
        World early{at_once, 1, number};
        for (int i = 0; i < 64; ++i) {
            early.sense();
            early.advance_uncommanded();
        }
        CHECK((vector3(late.truth().p_MoB_M_m) - vector3(early.truth().p_MoB_M_m)).norm() < 0.5);
        CHECK((vector3(late.truth().v_MB_M_mps) - vector3(early.truth().v_MB_M_mps)).norm() < 0.01);
        const NavigationSolution& known = early.solution();
        const auto believed = coast({vector3(known.p_MoB_M_m), vector3(known.v_MB_M_mps)}, 1.0);
        CHECK((vector3(late.solution().p_MoB_M_m) - believed.p_MoB_M).norm() < 0.5);
        CHECK((vector3(late.solution().v_MB_M_mps) - believed.v_MB_M).norm() < 0.01);
        // What is on board knew the truth of the trunk; moved, it knows what ground knows.
        const Vector3 on_board = vector3(trunk.truth().p_MoB_M_m) + vector3(shift.p_MoB_M_m);
        CHECK((on_board - vector3(late.solution().p_MoB_M_m)).norm() < 0.01);
        CHECK(late.solution().entry == known.entry);
    }
}

TEST_CASE("at the moment of dispersion truth and knowledge have the scenario's deviations", "[simulation][campaign]") {
    const World trunk = flown_to_dispersion(0);
    const Dispersions& sigma = dispersed_later().dispersions;
    const auto of = [&](const std::function<double(const World&, const flight::NavigationShift&)>& value) {
        return deviation(1500, [&](std::uint64_t number) {
            World world{trunk};
            const auto shift = world.disperse(1, number);
            return value(world, shift);
        });
    };
    const auto error_m = [](const World& world, int axis) {
        const auto i = static_cast<std::size_t>(axis);
        return world.solution().p_MoB_M_m[i] - world.truth().p_MoB_M_m[i];
    };
    CHECK(of([&](const World& w, const auto&) { return error_m(w, 2); }) ==
          Approx(sigma.knowledge_position_m / std::sqrt(3.0)).epsilon(0.06));
    CHECK(of([&](const World& w, const auto&) { return w.solution().v_MB_M_mps[2] - w.truth().v_MB_M_mps[2]; }) ==
          Approx(sigma.knowledge_velocity_mps / std::sqrt(3.0)).epsilon(0.06));
    // North is z near the equator; the other parts of the delivery error hardly reach it.
    CHECK(of([&](const World& w, const auto&) { return w.truth().p_MoB_M_m[2]; }) ==
          Approx(sigma.delivery_position_m / std::sqrt(2.0)).epsilon(0.06));
    CHECK(of([](const World&, const auto& shift) { return 2.0 * shift.q_BB[1]; }) ==
          Approx(sigma.attitude_rad).epsilon(0.06));
    CHECK(of([](const World&, const auto& shift) { return shift.accelerometer_bias_mps2[0]; }) ==
          Approx(sigma.imu_bias_mps2).epsilon(0.06));
}

TEST_CASE("an impossible moment of dispersion is named", "[simulation][scenario][campaign]") {
    Scenario scenario = tests::gale_scenario(700.0);
    CHECK_FALSE(disperses_later(scenario));
    scenario.disperse_before_entry_s = 700.0;
    CHECK(impossible_values(scenario).empty());
    CHECK_FALSE(disperses_later(scenario));  // at the start, as ever
    for (const auto& [value, says] : {std::pair{701.0, "disperse_before_entry_s: 701 is not between"},
                                      std::pair{-1.0, "disperse_before_entry_s: -1 is not between"},
                                      std::pair{10.01, "disperse_before_entry_s: 10.01 is not a multiple of 1/64 s"}}) {
        scenario.disperse_before_entry_s = value;
        const auto found = impossible_values(scenario);
        REQUIRE(found.size() == 1);
        CHECK_THAT(found.front(), Catch::StartsWith(says));
    }
}

}  // namespace simulation_dispersion_test
