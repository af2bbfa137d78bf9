// SPDX-License-Identifier: Apache-2.0
#include "common/mars_orientation.hpp"

#include "tests/support/catch.hpp"

#include <cmath>

namespace common_mars_orientation_test {

using namespace aeolis;

TEST_CASE("a state goes to rotating Mars and back, and what stands there moves in J2000", "[ephemeris][frames]") {
    const EphemerisTime time{397501914.56};
    const PositionAndVelocity standing{{3390.0, 100.0, -270.0}, {0.0, 0.0, 0.0}};
    const auto inertial = to_j2000(standing, time);
    const double speed = std::hypot(inertial.velocity[0], inertial.velocity[1], inertial.velocity[2]);
    CHECK(std::abs(speed - std::hypot(3390.0, 100.0) * 7.0882180e-5) < 1e-6);  // [km/s], a turn in 24 h 37 min 22.66 s
    // A second later it is where that velocity has taken it.
    const auto later = to_j2000(standing, time + 1.0);
    for (std::size_t axis = 0; axis < 3; ++axis)
        CHECK(std::abs(later.position.at(axis) - inertial.position.at(axis) - inertial.velocity.at(axis)) < 1e-4);
    const auto back = to_mars_fixed(inertial, time);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        CHECK(std::abs(back.position.at(axis) - standing.position.at(axis)) < 1e-9);
        CHECK(std::abs(back.velocity.at(axis)) < 1e-12);
    }
}

}  // namespace common_mars_orientation_test
