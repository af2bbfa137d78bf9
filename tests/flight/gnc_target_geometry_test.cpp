// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/entry/target_geometry.hpp"
#include "tests/support/catch.hpp"

#include <cmath>

namespace flight_gnc_target_geometry_test {

using namespace aeolis::flight::gnc;

namespace {
constexpr double radius_m = 3391148.0;
const Vector3 equator(3400000.0, 0.0, 0.0);
const Vector3 east(0.0, 5000.0, -1000.0);
}  // namespace

TEST_CASE("MSL at entry interface has 634.2 km to go", "[gnc][R27]") {
    const Vector3 p = 3522200.0 * direction_of(-3.9226 * degree, 126.703 * degree);
    const Vector3 v = Vector3::UnitZ().cross(p).normalized() * 5845.2;
    const TargetGeometry geometry = target_geometry(p, v, direction_of(-4.6019 * degree, 137.4102 * degree), radius_m);
    CHECK(geometry.range_to_go_m == Approx(634200.0).epsilon(2e-3));  // [facts], on a sphere of the landing radius
}

TEST_CASE("a target to the right has positive crossrange, one ahead has none", "[gnc][R27]") {
    const auto ahead = target_geometry(equator, {0, 5000, 0}, direction_of(0.0, 0.1), radius_m);
    CHECK(ahead.crossrange_m == Approx(0.0).margin(1e-6));
    CHECK(ahead.downrange_m == Approx(0.1 * radius_m));
    const auto south = target_geometry(equator, {0, 5000, 0}, direction_of(-0.01, 0.1), radius_m);
    CHECK(south.crossrange_m == Approx(0.01 * radius_m).epsilon(1e-3));  // flying east, south is right
    const auto passed = target_geometry(equator, {0, 5000, 0}, direction_of(0.0, -0.1), radius_m);
    CHECK(passed.downrange_m < 0.0);
    CHECK(passed.range_to_go_m == Approx(0.1 * radius_m));
}

TEST_CASE("lift points away from where the heatshield leans", "[gnc][R27]") {
    for (const double bank_deg : {0.0, 30.0, -77.0, 120.0, 179.0}) {
        const double bank = bank_deg * degree, lean = 16.0 * degree;
        const Vector3 forward = east.normalized();
        const Vector3 right = east.cross(equator).normalized();
        const Vector3 up = right.cross(forward);
        const Vector3 lift = std::cos(bank) * up + std::sin(bank) * right;
        const Vector3 z = std::cos(lean) * forward - std::sin(lean) * lift;
        const Quaternion q_MB = Quaternion::FromTwoVectors(Vector3::UnitZ(), z);
        CHECK(bank_of(q_MB, equator, east) == Approx(bank).margin(1e-9));
        CHECK(angle_of_attack(q_MB, east) == Approx(lean));
    }
}

}  // namespace flight_gnc_target_geometry_test
