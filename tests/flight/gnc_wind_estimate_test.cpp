// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/navigation/wind_estimate.hpp"
#include "tests/support/catch.hpp"

#include <cmath>

namespace flight_gnc_wind_estimate_test {

using namespace aeolis::flight::gnc;

namespace {

constexpr aeolis::flight::Parameters parameters;
const Vector3 up = Vector3{1.0, 1.0, -0.1}.normalized();
const Vector3 east = Vector3::UnitZ().cross(up).normalized();
const Vector3 north = up.cross(east);

/// A glide at a steady descent rate; its velocity follows the air and the lift as they accelerate it.
struct Glide {
    Vector3 wind_M = Vector3::Zero();
    double lift_to_drag = 0.17;
    double turns_dps = 4.5;
    double sinks_mps = 85.0;
    Vector3 level_M = Vector3::Zero();  ///< horizontal velocity
    double t_s = 0.0;

    void fly(WindEstimate& wind, double for_s) {
        constexpr double weight_mps2 = 3.7, cycle_s = 1.0 / 64.0;
        for (const double end_s = t_s + for_s; t_s < end_s; t_s += cycle_s) {
            const double angle = turns_dps * degree * t_s;
            const Vector3 lift = std::cos(angle) * east - std::sin(angle) * north;
            const Vector3 air_M = (level_M - wind_M) / sinks_mps;
            const Vector3 pull = weight_mps2 * (up - air_M + lift_to_drag * lift);
            wind.on(parameters, up, level_M - sinks_mps * up, pull);
            level_M += cycle_s * (pull - pull.dot(up) * up);
        }
    }
};

}  // namespace

TEST_CASE("the wind is the middle of the circle on which the parachute pulls, whatever the velocity was and has become",
          "[gnc][R27]") {
    for (const Vector3& wind_M : {Vector3{8.0 * east - 5.0 * north}, Vector3{-30.0 * east}, Vector3{0.0 * east}})
        for (const Vector3& level_M : {Vector3{0.0 * east}, Vector3{25.0 * east + 10.0 * north}}) {
            Glide glide{wind_M};
            glide.level_M = level_M;
            WindEstimate wind;
            glide.fly(wind, 90.0);
            const auto found_M = wind.wind_M(parameters, up);
            REQUIRE(found_M);
            CHECK((*found_M - wind_M).norm() < 0.05);
            CHECK(std::abs(found_M->dot(up)) < 1e-9);
            CHECK((glide.level_M - wind_M).norm() > 3.0);  // the velocity itself does not tell
        }
}

TEST_CASE("less than half a turn of the parachute's lift does not show the wind", "[gnc][R27]") {
    Glide glide{5.0 * east};
    WindEstimate wind;
    glide.fly(wind, 38.0);
    CHECK_FALSE(wind.wind_M(parameters, up));
    glide.fly(wind, 5.0);
    CHECK(wind.wind_M(parameters, up));
}

TEST_CASE("a pull that goes round nothing does not show the wind", "[gnc][R27]") {
    Glide steady{5.0 * east};
    steady.turns_dps = 0.0;
    WindEstimate of_steady;
    steady.fly(of_steady, 90.0);
    CHECK_FALSE(of_steady.wind_M(parameters, up));

    // Gusts of 3 m/s from all sides, and no lift: there is no circle, but a cloud.
    WindEstimate of_gusts;
    Glide gusty;
    gusty.lift_to_drag = 0.0;
    for (int i = 0; i < 90; ++i) {
        const double angle = 2.4 * i, gust_mps = 0.3 * (i % 20);
        gusty.wind_M = 5.0 * east + gust_mps * (std::cos(angle) * east + std::sin(angle) * north);
        gusty.fly(of_gusts, 1.0);
    }
    CHECK_FALSE(of_gusts.wind_M(parameters, up));
}

TEST_CASE("flight that is not steep tells nothing of the wind", "[gnc][R27]") {
    const auto found = [](double slope) {
        WindEstimate wind;
        for (int second = 0; second < 80; ++second)
            for (int cycle = 0; cycle < 64; ++cycle) {
                const double angle = 4.5 * degree * second;
                const Vector3 lift = std::cos(angle) * east - std::sin(angle) * north;
                wind.on(parameters, up, slope * 85.0 * east - 85.0 * up, 3.7 * (up - slope * east + 0.17 * lift));
            }
        return wind.wind_M(parameters, up).has_value();
    };
    CHECK(found(0.17));        // the pull leans by up to 0.34
    CHECK_FALSE(found(0.53));  // by 0.36 and more
}

TEST_CASE("few samples do not show the wind, however far they turn", "[gnc][R27]") {
    Glide fast{5.0 * east};
    fast.turns_dps = 20.0;
    WindEstimate wind;
    fast.fly(wind, 19.5);
    CHECK_FALSE(wind.wind_M(parameters, up));
    fast.fly(wind, 1.0);
    CHECK(wind.wind_M(parameters, up));
}

}  // namespace flight_gnc_wind_estimate_test
