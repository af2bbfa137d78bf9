// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/mars.hpp"
#include "tests/support/catch.hpp"

#include <cmath>

namespace flight_gnc_mars_test {

using namespace aeolis::flight::gnc;

namespace {

/// The potential whose gradient gravity is, written as textbooks do, with the Legendre polynomial.
double potential(const Vector3& p) {
    const double r = p.norm(), s = p.z() / r;
    const double a = mars_equator_radius_m / r;
    return mars_gm_m3ps2 / r * (1.0 - mars_j2 * a * a * 0.5 * (3.0 * s * s - 1.0));
}

}  // namespace

TEST_CASE("gravity is the gradient of the potential with J2", "[gnc][R27]") {
    const Vector3 p(1.2e6, -2.9e6, 1.5e6);
    constexpr double h = 10.0;
    for (int axis = 0; axis < 3; ++axis) {
        const Vector3 d = h * Vector3::Unit(axis);
        const double slope = (potential(p + d) - potential(p - d)) / (2.0 * h);
        CHECK(gravity(p)[axis] == Approx(slope).epsilon(1e-7));
    }
}

TEST_CASE("weight at Gale is 3.71 m/s² within half a percent", "[gnc][R27]") {
    const double latitude = -4.6 * degree;
    const Vector3 p = 3391148.0 * Vector3(std::cos(latitude), 0.0, std::sin(latitude));
    CHECK(-free_acceleration(p, Vector3::Zero()).dot(p.normalized()) == Approx(3.71).epsilon(0.005));
}

TEST_CASE("a body at rest in inertial space turns backwards in M", "[gnc][R27]") {
    // Relative to M it moves at −ω × p and must feel −ω × (that) + gravity: a circle about the spin axis.
    const Vector3 w(0.0, 0.0, mars_spin_rps), p(3.4e6, 1.0e5, 2.0e5);
    const Vector3 v = -w.cross(p);
    CHECK((free_acceleration(p, v) - gravity(p) - w.cross(w.cross(p))).norm() < 1e-12);
}

TEST_CASE("sound takes about 218 m/s in the 194.5 K at the ground and is held above the table", "[gnc]") {
    CHECK(speed_of_sound_mps(0.0) == Approx(218.5).epsilon(0.01));
    CHECK(speed_of_sound_mps(-100.0) == speed_of_sound_mps(0.0));
    CHECK(speed_of_sound_mps(500000.0) == speed_of_sound_mps(117647.0));
}

}  // namespace flight_gnc_mars_test
