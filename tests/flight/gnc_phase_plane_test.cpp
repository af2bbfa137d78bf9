// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/attitude/phase_plane.hpp"

#include "tests/support/catch.hpp"

namespace flight_gnc_phase_plane_test {

using namespace aeolis::flight::gnc;

TEST_CASE("a turn by the phase plane ends in its deadband without going past it, whatever its size", "[gnc][R27]") {
    const TurnLimits limits{0.35, 0.07, 0.01, 1.0, 0.7};
    for (const double start_rad : {0.05, 0.4, 1.5, 3.1, -2.0}) {
        double left_rad = start_rad, rate_rps = 0.0, fastest_rps = 0.0;
        for (int cycle = 0; cycle < 64 * 60; ++cycle) {
            const double wanted_rps = rate_to_turn(left_rad, limits);
            const double change = std::clamp((wanted_rps - rate_rps) / 0.25, -0.07, 0.07) / 64.0;
            rate_rps += change;
            left_rad -= rate_rps / 64.0;
            fastest_rps = std::max(fastest_rps, std::abs(rate_rps));
            CHECK(left_rad * start_rad > 0.0);  // never past the end
        }
        CHECK(std::abs(left_rad) < 0.0125);
        CHECK(std::abs(rate_rps) < 1.0e-3);
        CHECK(fastest_rps <= 0.3501);
    }
}

TEST_CASE("within the deadband no rate is wanted, just outside hardly any", "[gnc][R27]") {
    const TurnLimits limits{0.35, 0.07, 0.01, 1.0, 0.7};
    CHECK(rate_to_turn(0.01, limits) == 0.0);
    CHECK(rate_to_turn(-0.0099, limits) == 0.0);
    CHECK(rate_to_turn(0.0101, limits) == Approx(1.0e-4));
    CHECK(rate_to_turn(-0.0101, limits) == Approx(-1.0e-4));
    CHECK(rate_to_turn(3.0, limits) == 0.35);
}

}  // namespace flight_gnc_phase_plane_test
