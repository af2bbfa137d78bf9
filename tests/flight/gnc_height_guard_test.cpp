// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/entry/height_guard.hpp"

#include "flight/gnc/vector.hpp"
#include "generated/dictionary_flight.hpp"
#include "tests/support/catch.hpp"

namespace flight_gnc_height_guard_test {

using namespace aeolis::flight;
using namespace aeolis::flight::gnc;
constexpr aeolis::flight::Parameters parameters;

TEST_CASE("with lift up the published entry comes to the parachute's speed far above the guard", "[gnc][R27]") {
    // OD137 at its second reversal: 19.5 km, 2415 m/s [facts]; path and drag as our own flight has them there.
    const double foreseen_m = altitude_when_slow_m(parameters, {19500.0, 2415.0, 130.0, 62.0, 0.27}, 405.0);
    CHECK(foreseen_m > parameters.height_guard_m + parameters.height_guard_band_m);
    CHECK(bank_allowed_rad(parameters, foreseen_m) == Approx(pi));
}

TEST_CASE("deeper or steeper is lower, more lift is higher", "[gnc][R27]") {
    const PullUp now{12000.0, 1500.0, 250.0, 70.0, 0.29};
    const double foreseen_m = altitude_when_slow_m(parameters, now, 405.0);
    CHECK(foreseen_m < now.altitude_m);
    PullUp steeper = now, better = now;
    steeper.descent_rate_mps = 350.0;
    better.lift_to_drag = 0.33;
    CHECK(altitude_when_slow_m(parameters, steeper, 405.0) < foreseen_m);
    CHECK(altitude_when_slow_m(parameters, better, 405.0) > foreseen_m);
    CHECK(altitude_when_slow_m(parameters, {12000.0, 400.0, 100.0, 5.0, 0.3}, 405.0) == 12000.0);  // it is slow already
}

TEST_CASE("at the guard only lift up is allowed, above its band any bank", "[gnc][R27]") {
    const double guard_m = parameters.height_guard_m, band_m = parameters.height_guard_band_m;
    CHECK(bank_allowed_rad(parameters, guard_m - 1.0) == 0.0);
    CHECK(bank_allowed_rad(parameters, guard_m + 0.5 * band_m) == Approx(0.5 * pi));
    CHECK(bank_allowed_rad(parameters, guard_m + band_m) == Approx(pi));
}

}  // namespace flight_gnc_height_guard_test
