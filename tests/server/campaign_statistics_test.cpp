// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/statistics.hpp"

#include "server/campaign/chart.hpp"
#include "simulation/random.hpp"
#include "tests/support/catch.hpp"

#include <cmath>
#include <numbers>

namespace server_campaign_statistics_test {

using namespace aeolis;
using namespace aeolis::server::campaign;

TEST_CASE("mean and deviation of a known sample", "[campaign][statistics]") {
    Moments moments;
    for (const double value : {2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0})
        moments.add(1.0e9 + value);  // far from zero, where sums of squares would lose it
    CHECK(moments.mean() == 1.0e9 + 5.0);
    CHECK(moments.deviation() == Approx(std::sqrt(32.0 / 7.0)));
    CHECK(Moments{}.deviation() == 0.0);
}

TEST_CASE("percentiles of numbers that come in order are interpolated between neighbours", "[campaign][statistics]") {
    Percentile least{0.0, 5}, p10{0.1, 5}, p50{0.5, 5}, p99{0.99, 5}, most{1.0, 5};
    for (const double value : {10.0, 20.0, 30.0, 40.0, 50.0})
        for (Percentile* each : {&least, &p10, &p50, &p99, &most}) each->add(value);
    CHECK(least.value() == 10.0);
    CHECK(p10.value() == Approx(14.0));
    CHECK(p50.value() == 30.0);
    CHECK(p99.value() == Approx(49.6));
    CHECK(most.value() == 50.0);
    Percentile even{0.5, 2};
    even.add(1.0);
    even.add(2.0);
    CHECK(even.value() == 1.5);
}

TEST_CASE("the 99 % ellipse of a Gaussian sample has its axes and azimuth, and holds 99 %", "[campaign][statistics]") {
    constexpr double long_m = 4000.0, short_m = 1000.0, azimuth_rad = 70.0 * std::numbers::pi / 180.0;
    constexpr int points = 20000;
    simulation::Random random{1, 0, simulation::Stream::delivery};
    PlaneMoments plane;
    int inside = 0;
    for (int i = 0; i < points; ++i) {
        const double along = long_m * random.normal(), across = short_m * random.normal();
        plane.add(300.0 + along * std::sin(azimuth_rad) + across * std::cos(azimuth_rad),
                  -200.0 + along * std::cos(azimuth_rad) - across * std::sin(azimuth_rad));
        if (std::pow(along / long_m, 2) + std::pow(across / short_m, 2) <= 9.210) ++inside;
    }
    const Ellipse ellipse = plane.ellipse_99();
    CHECK(ellipse.major_m == Approx(2.0 * long_m * std::sqrt(9.210)).epsilon(0.02));
    CHECK(ellipse.minor_m == Approx(2.0 * short_m * std::sqrt(9.210)).epsilon(0.02));
    CHECK(ellipse.azimuth_deg == Approx(70.0).margin(0.5));
    CHECK(ellipse.east_m == Approx(300.0).margin(100.0));
    CHECK(ellipse.north_m == Approx(-200.0).margin(100.0));
    CHECK(static_cast<double>(inside) / points == Approx(0.99).margin(0.003));
}

TEST_CASE("an ellipse's azimuth runs from north to east over half a turn", "[campaign][statistics]") {
    const auto azimuth_of = [](double east, double north) {
        PlaneMoments plane;
        plane.add(-east, -north);
        plane.add(east, north);
        return plane.ellipse_99().azimuth_deg;
    };
    CHECK(azimuth_of(0.0, 1.0) == Approx(0.0).margin(1e-9));
    CHECK(azimuth_of(1.0, 1.0) == Approx(45.0));
    CHECK(azimuth_of(1.0, 0.0) == Approx(90.0));
    CHECK(azimuth_of(1.0, -1.0) == Approx(135.0));
    CHECK(PlaneMoments{}.ellipse_99().major_m == 0.0);
}

TEST_CASE("ticks of an axis are round numbers within it", "[campaign]") {
    const auto ticks = ticks_of({"", -7.3, 4.1}, 6);
    CHECK(ticks.values == std::vector<double>{-6.0, -4.0, -2.0, 0.0, 2.0, 4.0});
    CHECK(ticks.digits == 0);
    const auto fine = ticks_of({"", 0.65, 0.85}, 4);
    CHECK(fine.values.size() == 5);
    CHECK(fine.digits == 2);
    CHECK(ticks_of({"", 1.0, 1.0}, 5).values.empty());
}

}  // namespace server_campaign_statistics_test
