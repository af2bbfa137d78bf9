// SPDX-License-Identifier: Apache-2.0
#include "simulation/mars/wind.hpp"

#include "tests/support/catch.hpp"

#include <cmath>
#include <vector>

namespace simulation_wind_test {

using namespace aeolis::simulation;

namespace {

const Vector3 p_site = place(-4.6 * degree_rad, 137.4 * degree_rad, 3391148.0);

Wind gusty(double deviation_mps, std::uint64_t case_number = 1) {
    return {0.0, 0.0, 0.0, Random{1, case_number, Stream::wind},
            Gusts{deviation_mps, Random{1, case_number, Stream::gust}}};
}

/// Deviation of the east wind over ten minutes at a height, and its correlation over `lag` steps.
struct Seen {
    double deviation_mps, correlation;
};
Seen seen(double altitude_m, double airspeed_mps, double step_s, int lag) {
    Wind wind = gusty(3.0);
    const Horizon local = horizon(p_site);
    std::vector<double> east;
    for (int i = 0; i < static_cast<int>(std::lround(8000.0 / step_s)); ++i) {
        wind.advance(p_site, wind.at(p_site, altitude_m) + airspeed_mps * local.up, altitude_m, step_s);
        east.push_back(wind.at(p_site, altitude_m).dot(local.east));
    }
    double squares = 0.0, products = 0.0;
    const auto n = east.size() - static_cast<std::size_t>(lag);
    for (std::size_t i = 0; i < n; ++i) {
        squares += east[i] * east[i];
        products += east[i] * east[i + static_cast<std::size_t>(lag)];
    }
    return {std::sqrt(squares / static_cast<double>(n)), products / squares};
}

}  // namespace

TEST_CASE("gusts have the deviation of their height whatever the step, and are alike over their length",
          "[simulation][wind]") {
    for (const double step_s : {0.05, 0.2}) {
        const auto lag = static_cast<int>(std::lround(1.0 / step_s));
        const Seen low = seen(200.0, 50.0, step_s, 2 * lag);  // 100 m of way, which is the length at 200 m
        CHECK(low.deviation_mps == Approx(3.0 * (1.0 - 200.0 / 5000.0)).epsilon(0.05));
        CHECK(low.correlation == Approx(std::exp(-1.0)).margin(0.05));
    }
    CHECK(seen(2500.0, 100.0, 0.2, 5).deviation_mps == Approx(1.5).epsilon(0.07));
}

TEST_CASE("without a deviation and above five kilometres there are no gusts", "[simulation][wind]") {
    Wind calm = gusty(0.0), wind = gusty(3.0);
    for (int i = 0; i < 100; ++i) {
        calm.advance(p_site, {0.0, 0.0, 80.0}, 100.0, 0.005);
        wind.advance(p_site, {0.0, 0.0, 80.0}, 6000.0, 0.005);
    }
    CHECK(calm.at(p_site, 100.0).isZero());
    CHECK(wind.at(p_site, 6000.0).isZero());
}

TEST_CASE("a case has its own gusts, and the same ones each time", "[simulation][wind]") {
    const auto after_a_second = [](std::uint64_t case_number) {
        Wind wind = gusty(3.0, case_number);
        for (int i = 0; i < 200; ++i) wind.advance(p_site, {0.0, 0.0, 80.0}, 1000.0, 0.005);
        return wind.at(p_site, 1000.0);
    };
    CHECK((after_a_second(1) - after_a_second(1)).isZero());
    CHECK((after_a_second(1) - after_a_second(2)).norm() > 0.1);
}

}  // namespace simulation_wind_test
