// SPDX-License-Identifier: Apache-2.0
#include "simulation/mars/height_grid.hpp"

#include "tests/support/catch.hpp"

#include <cmath>
#include <random>

namespace simulation_height_grid_test {

using namespace aeolis::simulation;

namespace {

/// Three columns and two rows, 100 m apart, the south-western node 150 m west and 50 m south of the target.
const HeightGrid small{{3, 2, -150.0, -50.0, 100.0}, {0.0, 10.0, 30.0, 20.0, 20.0, 60.0}};

}  // namespace

TEST_CASE("a grid gives its nodes, and between them the plane that each pair of sides asks for",
          "[simulation][terrain]") {
    CHECK(small.height_m(-150.0, -50.0) == 0.0);
    CHECK(small.height_m(-50.0, -50.0) == 10.0);
    CHECK(small.height_m(50.0, 50.0) == 60.0);
    CHECK(small.height_m(-100.0, -50.0) == 5.0);
    CHECK(small.height_m(-150.0, 0.0) == 10.0);
    CHECK(small.height_m(0.0, 0.0) == Approx(30.0));
    CHECK(small.rise(-100.0, -50.0).east == Approx(0.1));
    CHECK(small.rise(0.0, 0.0).east == Approx(0.3));
    CHECK(small.rise(0.0, 0.0).north == Approx(0.2));
}

TEST_CASE("beyond its nodes a grid goes on as at its edge, level towards the outside", "[simulation][terrain]") {
    CHECK(small.height_m(1.0e6, 1.0e6) == 60.0);
    CHECK(small.height_m(-1.0e6, 0.0) == 10.0);
    CHECK(small.rise(-1.0e6, 0.0).east == 0.0);
    CHECK(small.rise(-1.0e6, 0.0).north == Approx(0.2));
    CHECK(small.holds(50.0, 50.0));
    CHECK_FALSE(small.holds(50.1, 0.0));
    CHECK(small.covers(50.0));
    CHECK_FALSE(small.covers(51.0));
}

TEST_CASE("no slope between any two places of a grid is steeper than what it says", "[simulation][terrain]") {
    std::mt19937_64 random{7};
    const auto between = [&](double least, double most) {
        return std::uniform_real_distribution<double>{least, most}(random);
    };
    std::vector<double> heights_m(20 * 30);
    for (double& height_m : heights_m) height_m = between(-40.0, 40.0);
    const HeightGrid rough{{20, 30, -1000.0, -1500.0, 100.0}, heights_m};
    for (int i = 0; i < 20000; ++i) {
        const double east_m = between(-1200.0, 1200.0), north_m = between(-1700.0, 1700.0);
        const double to_east_m = between(-5.0, 5.0), to_north_m = between(-5.0, 5.0);
        const double step_m =
            rough.height_m(east_m + to_east_m, north_m + to_north_m) - rough.height_m(east_m, north_m);
        REQUIRE(std::abs(step_m) <= rough.steepest() * std::hypot(to_east_m, to_north_m) + 1e-9);
        const auto rise = rough.rise(east_m, north_m);
        REQUIRE(std::hypot(rise.east, rise.north) <= rough.steepest() + 1e-12);
    }
}

}  // namespace simulation_height_grid_test
