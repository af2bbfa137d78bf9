// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/powered_descent/vertical_profile.hpp"
#include "flight/gnc/triggers/triggers.hpp"
#include "tests/support/catch.hpp"

#include <cmath>

namespace flight_gnc_vertical_profile_test {

using namespace aeolis::flight::gnc;
using namespace aeolis::flight::gnc::powered_descent;
constexpr aeolis::flight::Parameters parameters;

TEST_CASE("from OD137's powered approach start the net deceleration comes out as published", "[gnc][R27]") {
    ApproachProfile profile;
    profile.start(parameters, 1380.0 + stage_height_at_touchdown_m(parameters), 90.5);
    CHECK(profile.deceleration_mps2() == Approx(3.19).epsilon(0.03));  // [facts]
}

TEST_CASE("following the profile ends at 32 m/s at the altitude meant", "[gnc][R27]") {
    ApproachProfile profile;
    double h = 1400.0, v = 92.0, t = 0.0;
    profile.start(parameters, h, v);
    for (; !all_hold(triggers::constant_velocity(parameters, h, v)) && t < 100.0; t += 0.01) {
        v -= profile.acceleration_mps2(parameters, h, v) * 0.01;
        h -= v * 0.01;
    }
    CHECK(v == Approx(32.0).margin(0.2));
    CHECK(h == Approx(approach_end_altitude_m(parameters)).margin(2.0));
}

TEST_CASE("an error of rate dies out with its gain", "[gnc][R27]") {
    ApproachProfile profile;
    profile.start(parameters, 1400.0, 92.0);
    CHECK(profile.acceleration_mps2(parameters, 1400.0, 94.0) - profile.acceleration_mps2(parameters, 1400.0, 92.0) ==
          Approx(parameters.deceleration_rate_gain_per_s));
}

TEST_CASE("constant deceleration takes 120 m from 32 m/s and ends at 0.75 m/s", "[gnc][R27]") {
    const double start_m = constant_deceleration_altitude_m(parameters, 32.0);
    CHECK(start_m - sky_crane_altitude_m(parameters) == Approx((32.0 * 32.0 - 0.75 * 0.75) / (2.0 * 4.26)));
    DecelerationProfile profile;
    profile.start(parameters, start_m, 32.0);
    CHECK(profile.deceleration_mps2() == Approx(4.26));
    double seconds = 0.0, altitude_m = start_m;
    for (; profile.descent_rate_mps() > 0.75 && seconds < 20.0; seconds += 0.01) {
        altitude_m -= 0.01 * profile.descent_rate_mps();
        profile.advance(parameters, altitude_m, 0.01);
    }
    CHECK(altitude_m == Approx(sky_crane_altitude_m(parameters)).margin(0.2));
    CHECK(seconds == Approx(7.3).margin(0.1));  // [facts]: 400.0 → 407.3
    CHECK(profile.acceleration_mps2(parameters, 0.75) == Approx(0.0).margin(1e-9));
}

TEST_CASE("constant deceleration ends where it should though the radar corrects the altitude on the way",
          "[gnc][R27]") {
    for (const double error_m : {-5.0, 5.0}) {
        DecelerationProfile profile;
        double true_m = constant_deceleration_altitude_m(parameters, 32.0) - error_m, seconds = 0.0;
        profile.start(parameters, true_m + error_m, 32.0);
        for (; profile.descent_rate_mps() > 0.75 && seconds < 20.0; seconds += 0.01) {
            true_m -= 0.01 * profile.descent_rate_mps();
            profile.advance(parameters, true_m + error_m * std::exp(-seconds / 3.0), 0.01);
        }
        CHECK(true_m + error_m * std::exp(-seconds / 3.0) == Approx(sky_crane_altitude_m(parameters)).margin(0.5));
    }
}

TEST_CASE("absurd starts give a deceleration that engines can fly", "[gnc][R27]") {
    DecelerationProfile profile;
    profile.start(parameters, 5.0, 40.0);
    CHECK(profile.deceleration_mps2() == 6.0);
    ApproachProfile approach;
    approach.start(parameters, 50000.0, 90.0);
    CHECK(approach.deceleration_mps2() == 1.0);
}

}  // namespace flight_gnc_vertical_profile_test
