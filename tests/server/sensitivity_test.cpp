// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/sensitivity.hpp"

#include "tests/support/catch.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace server_sensitivity_test {

using namespace aeolis;
using namespace aeolis::server::campaign;

TEST_CASE("each error belongs to one group, and a group's scenario has its errors and no others",
          "[campaign][analysis]") {
    simulation::Scenario scenario;
    scenario.name = "campaign";
    scenario.dispersions.terrain_height_m = 5.0;
    scenario.dispersions.density_aloft_fraction = 0.2;
    scenario.dispersions.parachute_oscillation_fraction = 0.1;
    scenario.dispersions.radar_sand_mps = 0.5;
    scenario.dispersions.terrain_roughness_m = 0.5;
    scenario.dispersions.terrain_slope_deg = 0.0;
    std::set<std::string> fields;
    std::size_t count = 0;
    for (const ErrorGroup& group : error_groups()) {
        count += group.fields.size();
        fields.insert(group.fields.begin(), group.fields.end());
    }
    CHECK(fields.size() == count);
    CHECK(count == sizeof(simulation::Dispersions) / sizeof(double));

    const auto only = with_errors(scenario, {"wind", {"wind_mps", "gust_mps"}});
    CHECK(only.name == "campaign-wind");
    CHECK(only.dispersions.wind_mps == scenario.dispersions.wind_mps);
    CHECK(only.dispersions.gust_mps == scenario.dispersions.gust_mps);
    CHECK(only.dispersions.density_fraction == 0.0);
    CHECK(only.dispersions.attitude_rad == 0.0);
    // One at a time: those that the scenario has.
    const auto singles = single_errors(scenario);
    CHECK(singles.size() == count - 1);
    for (const ErrorGroup& single : singles) CHECK(single.name != "terrain_slope_deg");

    // Deviations of density by height stand for the two fractions.
    scenario.density_scale = {{0.0, 1.1, 0.04}};
    const auto by_height = single_errors(scenario);
    CHECK(by_height.size() == singles.size() - 1);
    CHECK(std::ranges::count(by_height, "density_by_height", &ErrorGroup::name) == 1);
    CHECK(std::ranges::count(by_height, "density_fraction", &ErrorGroup::name) == 0);
    CHECK(with_errors(scenario, by_height[0]).density_scale[0].deviation == 0.04);
    CHECK(with_errors(scenario, {"wind", {"wind_mps"}}).density_scale[0].deviation == 0.0);
    CHECK(with_errors(scenario, {"wind", {"wind_mps"}}).density_scale[0].scale == 1.1);
}

TEST_CASE("an influence is along the course and across it, and the budget is the root of the sum of squares",
          "[campaign][analysis]") {
    CaseTable table;
    table.columns = {{"east_m", {}}, {"north_m", {}}, {"propellant_kg", {}}};
    for (int i = 0; i < 100; ++i) {  // 3 km along the course of 90 degrees, 1 km across it
        table.numbers.push_back(static_cast<std::uint64_t>(i) + 1);
        table.outcomes.emplace_back(i == 0 ? "lost" : "touchdown");
        table.columns[0].values.push_back(3000.0 * std::sqrt(2.0) * std::sin(0.7 * i));
        table.columns[1].values.push_back(1000.0 * std::sqrt(2.0) * std::cos(1.9 * i));
        table.columns[2].values.push_back(30.0 + i % 2);
    }
    const Influence one = influence_of("wind", table, 90.0);
    CHECK(one.landed == 99);
    CHECK(one.along_m == Approx(3000.0).epsilon(0.03));
    CHECK(one.across_m == Approx(1000.0).epsilon(0.03));
    CHECK(one.propellant_least_kg == 30.0);
    CHECK(influence_of("wind", table, 0.0).along_m == Approx(1000.0).epsilon(0.03));

    Influence other = one;
    other.group = "density";
    other.along_m = 4000.0;
    const std::string text = sensitivity_table({one, other}, one);
    CHECK(text.find("density") < text.find("wind"));  // the strongest first
    CHECK_THAT(text, Catch::Contains("root of sum of squares"));
    const double root_km = std::hypot(4.0, one.along_m / 1000.0);
    CHECK_THAT(text, Catch::Contains(std::to_string(root_km).substr(0, 5)));
    CHECK_THAT(sensitivity_csv({one, other}, one), Catch::StartsWith("errors,cases,landed,along_sigma_km,"));
}

TEST_CASE("of errors under which nothing lands no spread is said: it is not zero", "[campaign][analysis]") {
    CaseTable table;
    table.numbers = {1, 2};
    table.outcomes = {"lost", "touchdown"};
    const double none = std::nan("");
    table.columns = {{"east_m", {none, 900.0}}, {"north_m", {none, 100.0}}, {"propellant_kg", {none, 12.0}}};
    const Influence one = influence_of("wind", table, 90.0);
    CHECK(std::isnan(one.along_m));
    CHECK_FALSE(one.ellipse);
    CHECK(one.propellant_least_kg == 12.0);
    const std::string text = sensitivity_table({one}, one);
    CHECK_THAT(text, Catch::Contains("wind                           1/2         -         -"));
    CHECK_FALSE(text.find("nan") != std::string::npos);
    CHECK_THAT(sensitivity_csv({one}, one), Catch::Contains("wind,2,1,,,,,,,,,,,,12.00\n"));
}

}  // namespace server_sensitivity_test
