// SPDX-License-Identifier: Apache-2.0
#include "simulation/draws.hpp"

#include "simulation/world.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/support/catch.hpp"

#include <cmath>
#include <map>
#include <set>

namespace simulation_draws_test {

using namespace aeolis;
using namespace aeolis::simulation;

TEST_CASE("the draws of many cases have the scenario's deviations, each under its own name",
          "[simulation][dispersion]") {
    auto scenario = tests::gale_scenario();
    scenario.dispersions.terrain_height_m = 20.0;
    const Dispersions& sigma = scenario.dispersions;
    std::map<std::string, std::pair<double, double>> sums;  // of values, of squares
    constexpr int cases = 400;
    for (int number = 1; number <= cases; ++number)
        for (const Draw& draw : World{scenario, 1, static_cast<std::uint64_t>(number)}.draws()) {
            sums[draw.name].first += draw.value;
            sums[draw.name].second += draw.value * draw.value;
        }
    const std::map<std::string, double> expected{
        {"delivery_flight_path_deg", sigma.delivery_flight_path_deg},
        {"delivery_east_m", sigma.delivery_position_m / std::sqrt(2.0)},
        {"knowledge_position_y_m", sigma.knowledge_position_m / std::sqrt(3.0)},
        {"knowledge_velocity_z_mps", sigma.knowledge_velocity_mps / std::sqrt(3.0)},
        {"density_fraction", 0.8 * sigma.density_fraction},
        {"drag_fraction", sigma.drag_fraction},
        {"slow_drag_fraction", sigma.slow_drag_fraction},
        {"mass_fraction", sigma.mass_fraction},
        {"wind_east_mps", sigma.wind_mps},
        {"parachute_drag_fraction", sigma.parachute_drag_fraction},
        {"parachute_plane_deg", sigma.parachute_plane_deg},
        {"terrain_height_m", sigma.terrain_height_m},
        {"attitude_x_rad", sigma.attitude_rad},
        {"imu_bias_z_mps2", sigma.imu_bias_mps2},
        {"imu_misalignment_y_rad", sigma.imu_misalignment_rad},
        {"gyro_bias_x_rps", sigma.gyro_bias_rps},
        {"radar_range_fraction", sigma.radar_range_fraction},
        {"radar_velocity_3_mps", sigma.radar_velocity_mps},
    };
    for (const auto& [name, deviation] : expected) {
        INFO(name);
        REQUIRE(sums.contains(name));
        const auto& [sum, squares] = sums[name];
        CHECK(std::abs(sum / cases) < 3.5 * deviation / std::sqrt(cases));
        CHECK(std::sqrt(squares / cases) == Approx(deviation).epsilon(0.15));  // 4 sigma of 400 squares
    }
}

TEST_CASE("a landing without errors has none drawn, and one dispersed later has its case's from then on",
          "[simulation][dispersion]") {
    for (const Draw& draw : World{tests::undisturbed_scenario(), 1, 7}.draws()) {
        INFO(draw.name);
        CHECK(std::abs(draw.value) < 1e-12);
    }
    auto later = tests::gale_scenario(700.0);
    const auto at_once = World{later, 1, 7}.draws();
    later.disperse_before_entry_s = 699.0;
    World world{later, 1, 7};
    for (const Draw& draw : world.draws()) CHECK(std::abs(draw.value) < 1e-12);
    world.disperse(1, 7);
    const auto drawn = world.draws();
    REQUIRE(drawn.size() == at_once.size());
    std::set<std::string> names;
    for (std::size_t i = 0; i < drawn.size(); ++i) {
        INFO(drawn[i].name);
        CHECK(drawn[i].name == at_once[i].name);
        CHECK(drawn[i].value == Approx(at_once[i].value).margin(1e-9));
        CHECK(names.insert(drawn[i].name).second);
    }
}

}  // namespace simulation_draws_test
