// SPDX-License-Identifier: Apache-2.0
#include "simulation/mars/point_mass.hpp"

#include "tests/simulation/jacobi.hpp"
#include "tests/support/catch.hpp"

namespace simulation_point_mass_test {

using namespace aeolis::simulation;

namespace {

const PointMass approach{{3.0e6, 2.0e6, 6.0e5}, {-3200.0, 3900.0, -300.0}};

const auto vacuum = [](double, const Vector3&, const Vector3&) -> Vector3 { return Vector3::Zero(); };

PointMass flown(PointMass at, double duration_s, double step_s) {
    const auto steps = static_cast<int>(std::llround(duration_s / step_s));
    for (int i = 0; i < steps; ++i) at = runge_kutta_step(at, step_s, vacuum);
    return at;
}

}  // namespace

TEST_CASE("a vehicle in vacuum keeps its energy relative to rotating Mars", "[simulation][mars]") {
    const double before = aeolis::tests::jacobi_m2ps2(approach);
    const double after = aeolis::tests::jacobi_m2ps2(flown(approach, 500.0, 0.25));
    CHECK(std::abs(after - before) < 1e-3);  // of 10 MJ/kg
}

TEST_CASE("the integrator's error falls with the fourth power of its step", "[simulation][mars]") {
    const PointMass exact = flown(approach, 200.0, 0.125);
    const double coarse_m = (flown(approach, 200.0, 40.0).p_MoB_M - exact.p_MoB_M).norm();
    const double fine_m = (flown(approach, 200.0, 20.0).p_MoB_M - exact.p_MoB_M).norm();
    CHECK(coarse_m / fine_m > 13.0);
    CHECK(coarse_m / fine_m < 19.0);
}

TEST_CASE("coasting back and forth returns to the start within a millimetre", "[simulation][mars]") {
    const PointMass back = coast(coast(approach, -7200.0), 7200.0);
    CHECK((back.p_MoB_M - approach.p_MoB_M).norm() < 1e-3);
}

TEST_CASE("a ballistic entry decelerates as Allen and Eggers say", "[simulation][mars]") {
    // Exponential air, constant drag, steep: peak = V² sin γ / (2 e H), at V e^-1/2. [allen-eggers-1958]
    constexpr double scale_height_m = 10000.0, speed_mps = 6000.0, angle_rad = 60.0 * degree_rad;
    constexpr double ballistic_kgm2 = 146.0, surface_kgm3 = 0.02;
    const Vector3 up = Vector3::UnitX(), along = Vector3::UnitY();
    constexpr double ground_m = 3.39e6;
    PointMass at{(ground_m + 120000.0) * up, speed_mps * (-std::sin(angle_rad) * up + std::cos(angle_rad) * along)};
    double peak_mps2 = 0.0, speed_at_peak_mps = 0.0;
    const auto drag = [&](double, const Vector3& p, const Vector3& v) -> Vector3 {
        const double density = surface_kgm3 * std::exp(-(p.norm() - ground_m) / scale_height_m);
        return -0.5 * density / ballistic_kgm2 * v.norm() * v;
    };
    while (at.p_MoB_M.norm() > ground_m + 1000.0) {
        Vector3 felt;
        at = runge_kutta_step(at, 0.005, drag, &felt);
        if (felt.norm() > peak_mps2) peak_mps2 = felt.norm(), speed_at_peak_mps = at.v_MB_M.norm();
    }
    const double expected_mps2 = speed_mps * speed_mps * std::sin(angle_rad) / (2.0 * std::numbers::e * scale_height_m);
    CHECK(peak_mps2 == Approx(expected_mps2).epsilon(0.03));  // theory leaves gravity out
    CHECK(speed_at_peak_mps == Approx(speed_mps * std::exp(-0.5)).epsilon(0.03));
}

}  // namespace simulation_point_mass_test
