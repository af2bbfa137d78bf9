// SPDX-License-Identifier: Apache-2.0
#include "simulation/mars/terrain.hpp"

#include "tests/simulation/gale.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/gnc_venue.hpp"

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

namespace simulation_terrain_test {

using namespace aeolis;
using namespace aeolis::simulation;

namespace {

Scenario with_ground(const Ground& ground) {
    Scenario scenario = tests::undisturbed_scenario();
    scenario.ground = ground;
    return scenario;
}

Terrain terrain_of(const Scenario& scenario, std::uint64_t case_number = 0) {
    return {scenario, Random{1, case_number, Stream::terrain}};
}

/// Over the target, `north_m` and `east_m` away.
Vector3 over_target(const Scenario& scenario, double height_m, double north_m = 0.0, double east_m = 0.0) {
    const Horizon at =
        horizon(place(scenario.target.latitude_deg * degree_rad, scenario.target.longitude_deg * degree_rad, 1.0));
    const Vector3 direction = scenario.target.radius_m * at.up + north_m * at.north + east_m * at.east;
    return direction.normalized() * (scenario.target.radius_m + height_m);
}

}  // namespace

TEST_CASE("without height and slope the ground is the sphere of the landing radius", "[simulation][terrain]") {
    const Scenario scenario = with_ground({});
    const Terrain flat = terrain_of(scenario);
    const Vector3 p = over_target(scenario, 2000.0, 7000.0, -3000.0);
    CHECK(flat.radius_m(p) == scenario.target.radius_m);
    CHECK(flat.height_m(p) == Approx(2000.0));
    CHECK((flat.normal(p) - p.normalized()).isZero());
    const auto below = flat.meet(p, -p.normalized());
    CHECK(below.meets);
    CHECK(below.range_m == Approx(2000.0));
    CHECK_FALSE(flat.meet(p, p.normalized()).meets);
}

TEST_CASE("rough ground has the deviation and the slopes that its scenario says, others in each case, and is seamless",
          "[simulation][terrain]") {
    Scenario scenario = with_ground({});
    scenario.dispersions.terrain_roughness_m = 2.0;
    scenario.ground.roughness_length_m = 40.0;
    const Terrain rough = terrain_of(scenario), other = terrain_of(scenario, 1);
    const double radius_m = scenario.target.radius_m;
    const auto height_m = [&](const Terrain& terrain, double north_m, double east_m) {
        return terrain.radius_m(over_target(scenario, 0.0, north_m, east_m)) - radius_m;
    };
    double squares = 0.0, slopes = 0.0;
    int differ = 0;
    constexpr int side = 60;
    for (int row = 0; row < side; ++row)
        for (int column = 0; column < side; ++column) {
            const double north_m = 40.0 * row, east_m = 40.0 * column, here_m = height_m(rough, north_m, east_m);
            squares += here_m * here_m;
            slopes += std::pow((height_m(rough, north_m, east_m + 40.0) - here_m) / 40.0, 2);
            differ += std::abs(height_m(other, north_m, east_m) - here_m) > 0.1;
        }
    CHECK(std::sqrt(squares / (side * side)) == Approx(2.0).epsilon(0.1));
    CHECK(std::sqrt(slopes / (side * side)) == Approx(std::sqrt(2.0) * 2.0 / 40.0).epsilon(0.1));
    CHECK(differ > 0.8 * side * side);
    // The seam of the square, 64 nodes from the target, is none.
    for (const double north_m : {-2561.0, -1.0, 2559.0})
        CHECK(height_m(rough, north_m, 37.0) == Approx(height_m(rough, north_m + 2.0, 37.0)).margin(0.8));
    // A ray down meets it where it is, and its normal is that of the slope.
    const Vector3 p = over_target(scenario, 500.0, 130.0, -75.0);
    const auto below = rough.meet(p, -p.normalized());
    REQUIRE(below.meets);
    CHECK(below.range_m == Approx(rough.height_m(p)).margin(0.02));
    CHECK(below.incidence_cosine == Approx(rough.normal(p).dot(p.normalized())));
    // Who draws nothing has none.
    CHECK(terrain_of(undispersed(scenario)).radius_m(p) == radius_m);
}

TEST_CASE("the ground rises towards its azimuth by its slope, and a ray meets it there", "[simulation][terrain]") {
    const Scenario scenario = with_ground({-30.0, 10.0, 90.0});
    const Terrain tilted = terrain_of(scenario);
    const double rise = std::tan(10.0 * degree_rad);
    CHECK(tilted.height_m(over_target(scenario, 0.0)) == Approx(30.0));
    CHECK(tilted.height_m(over_target(scenario, 0.0, 0.0, 1000.0)) == Approx(30.0 - 1000.0 * rise).margin(0.1));
    CHECK(tilted.height_m(over_target(scenario, 0.0, 1000.0, 0.0)) == Approx(30.0).margin(0.1));

    const Vector3 p = over_target(scenario, 970.0);  // 1000 m above the ground
    const Horizon at = horizon(p);
    CHECK(tilted.normal(p).dot(at.up) == Approx(std::cos(10.0 * degree_rad)));
    CHECK(tilted.normal(p).dot(at.east) == Approx(-std::sin(10.0 * degree_rad)));
    for (const double off_deg : {-50.0, -20.0, 0.0, 20.0, 50.0}) {
        const Vector3 direction = -std::cos(off_deg * degree_rad) * at.up + std::sin(off_deg * degree_rad) * at.east;
        const auto meeting = tilted.meet(p, direction);
        REQUIRE(meeting.meets);
        CHECK(std::abs(tilted.height_m(p + meeting.range_m * direction)) < 0.5);
        CHECK(meeting.incidence_cosine == Approx(std::cos((off_deg - 10.0) * degree_rad)));
    }
}

TEST_CASE("far from the site the ground is level: a slope there is no mountain at entry", "[simulation][terrain]") {
    Scenario scenario = tests::undisturbed_scenario();
    scenario.ground.slope_deg = 20.0;
    scenario.ground.uphill_azimuth_deg = 270.0;
    const Terrain slope{scenario, Random{1, 0, Stream::terrain}};
    const Vector3 entry =
        place(scenario.entry.latitude_deg * degree_rad, scenario.entry.longitude_deg * degree_rad, 3.5222e6);
    CHECK(slope.height_m(entry) == Approx(131052.0 - 30000.0 * std::tan(20.0 * degree_rad)).margin(100.0));
}

TEST_CASE("a case has its own height and rise, of the scenario's deviations", "[simulation][terrain]") {
    Scenario scenario = with_ground({});
    scenario.dispersions.terrain_height_m = 100.0;
    scenario.dispersions.terrain_slope_deg = 2.0;
    double heights_m2 = 0.0, rises2 = 0.0;
    const Vector3 p = over_target(scenario, 0.0);
    for (std::uint64_t i = 1; i <= 1000; ++i) {
        const Terrain terrain = terrain_of(scenario, i);
        heights_m2 += std::pow(terrain.height_m(p), 2);
        rises2 += std::pow(terrain.normal(p).dot(horizon(p).east), 2);
    }
    CHECK(std::sqrt(heights_m2 / 1000.0) == Approx(100.0).epsilon(0.07));
    CHECK(std::sqrt(rises2 / 1000.0) == Approx(std::sin(2.0 * degree_rad)).epsilon(0.07));
}

namespace {

/// Hills of 60 m with 400 m from top to top, steep to one side, over 6 km around the target.
std::shared_ptr<const HeightGrid> hills() {
    constexpr std::size_t nodes = 241;
    constexpr double cell_m = 25.0, half_m = 0.5 * cell_m * (nodes - 1);
    std::vector<double> heights_m;
    for (std::size_t row = 0; row < nodes; ++row)
        for (std::size_t column = 0; column < nodes; ++column) {
            const double x = cell_m * static_cast<double>(column), y = cell_m * static_cast<double>(row);
            heights_m.push_back(30.0 * std::sin(x / 64.0) * std::cos(y / 90.0) + 0.02 * x);
        }
    return std::make_shared<const HeightGrid>(HeightGrid::Shape{nodes, nodes, -half_m, -half_m, cell_m}, heights_m);
}

}  // namespace

TEST_CASE("a ray meets the ground of a grid where it first comes to it, and nowhere before", "[simulation][terrain]") {
    Scenario scenario = with_ground({-30.0, 2.0, 45.0});
    scenario.ground.grid = hills();
    const Terrain terrain = terrain_of(scenario);
    int met = 0;
    for (int i = 0; i < 200; ++i) {
        const Vector3 p = over_target(scenario, 100.0 + 10.0 * i, 9.0 * i - 900.0, 700.0 - 11.0 * i);
        const Horizon at = horizon(p);
        const double off_rad = (i % 60) * degree_rad, turn_rad = 0.7 * i;
        const Vector3 direction = -std::cos(off_rad) * at.up +
                                  std::sin(off_rad) * (std::sin(turn_rad) * at.east + std::cos(turn_rad) * at.north);
        const auto meeting = terrain.meet(p, direction);
        if (!meeting.meets) continue;
        ++met;
        CHECK(std::abs(terrain.height_m(p + meeting.range_m * direction)) < 0.02 + 2e-5 * meeting.range_m);
        CHECK(meeting.incidence_cosine == Approx(-direction.dot(terrain.normal(p + meeting.range_m * direction))));
        for (double range_m = 0.0; range_m < meeting.range_m - 1.0; range_m += 2.0)
            REQUIRE(terrain.height_m(p + range_m * direction) > 0.0);
    }
    CHECK(met == 200);
    const Vector3 over = over_target(scenario, 500.0);
    CHECK_FALSE(terrain.meet(over, over.normalized()).meets);
}

TEST_CASE("one steep place far away takes no echo from a beam that is flat and high", "[simulation][terrain]") {
    Scenario scenario = with_ground({});
    std::vector<double> heights_m(101 * 101, 0.0);
    heights_m[0] = 490.0;
    scenario.ground.grid =
        std::make_shared<const HeightGrid>(HeightGrid::Shape{101, 101, -5000.0, -5000.0, 100.0}, std::move(heights_m));
    const Terrain terrain = terrain_of(scenario);
    const Vector3 p = over_target(scenario, 8000.0);
    const Horizon at = horizon(p);
    for (const double off_deg : {0.0, 40.0, 65.0}) {
        const auto meeting =
            terrain.meet(p, -std::cos(off_deg * degree_rad) * at.up + std::sin(off_deg * degree_rad) * at.east);
        REQUIRE(meeting.meets);
        CHECK(meeting.range_m == Approx(8000.0 / std::cos(off_deg * degree_rad)).epsilon(0.01));
    }
}

TEST_CASE("the normal of a grid's ground is across the slope that its heights have", "[simulation][terrain]") {
    Scenario scenario = with_ground({});
    scenario.ground.grid = hills();
    const Terrain terrain = terrain_of(scenario);
    const Vector3 p = over_target(scenario, 50.0, 40.0, -60.0);
    const Horizon at = horizon(p);
    constexpr double step_m = 0.5;
    const double rise_east =
        (terrain.radius_m(p + step_m * at.east) - terrain.radius_m(p - step_m * at.east)) / (2.0 * step_m);
    const double rise_north =
        (terrain.radius_m(p + step_m * at.north) - terrain.radius_m(p - step_m * at.north)) / (2.0 * step_m);
    const Vector3 expected = (at.up - rise_east * at.east - rise_north * at.north).normalized();
    CHECK(terrain.normal(p).dot(expected) == Approx(1.0).margin(1e-5));
}

TEST_CASE("GNC lands softly on the hills of a grid, at the height that the grid has there",
          "[simulation][terrain][gnc]") {
    Scenario scenario = with_ground({});
    scenario.ground.grid = hills();
    tests::GncVenue venue(scenario, 1);
    venue.run();
    REQUIRE(venue.world().outcome() == Outcome::touchdown);
    const auto& touchdown = venue.world().touchdown();
    REQUIRE(touchdown);
    CHECK(touchdown->vertical_mps == Approx(0.75).margin(0.15));
    CHECK(touchdown->horizontal_mps <= 0.5);
    CHECK(venue.world().outcome_reason() == "the rover stands, the descent stage is away");
    // Beyond it the edge goes on, and that is said.
    scenario.ground.grid =
        std::make_shared<const HeightGrid>(HeightGrid::Shape{2, 2, -100.0, -100.0, 10.0}, std::vector<double>(4, 0.0));
    tests::GncVenue beyond(scenario, 1);
    beyond.run();
    CHECK_THAT(beyond.world().outcome_reason(), Catch::StartsWith("the rover stands beyond the grid"));
}

TEST_CASE("GNC lands softly on ground that is higher, lower or tilted: the radar tells it",
          "[simulation][terrain][gnc]") {
    for (const Ground& ground : {Ground{150.0, 0.0, 0.0}, Ground{-150.0, 0.0, 0.0}, Ground{0.0, 5.0, 45.0}}) {
        INFO(ground.height_m << " m, " << ground.slope_deg << " deg");
        tests::GncVenue venue(with_ground(ground), 1);
        venue.run();
        REQUIRE(venue.world().outcome() == Outcome::touchdown);
        const auto& touchdown = venue.world().touchdown();
        REQUIRE(touchdown);
        CHECK(touchdown->vertical_mps == Approx(0.75).margin(0.1));
        CHECK(touchdown->horizontal_mps <= 0.5);
    }
}

}  // namespace simulation_terrain_test
