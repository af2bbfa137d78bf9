// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/mars.hpp"
#include "flight/gnc/navigation/strapdown.hpp"
#include "tests/support/catch.hpp"

#include <cmath>

namespace flight_gnc_strapdown_test {

using namespace aeolis;
using namespace aeolis::flight::gnc;
constexpr aeolis::flight::Parameters parameters;

namespace {

flight::ImuSample sample(std::uint32_t count, const Vector3& delta_v, const Vector3& delta_angle) {
    return {count, to_array(delta_v), to_array(delta_angle)};
}

NavigatedState over_gale() {
    NavigatedState state;
    state.p_MoB_M = {3395000.0, 0.0, 0.0};
    return state;
}

}  // namespace

TEST_CASE("a vehicle held up against its weight stays where it is", "[gnc][R27]") {
    Strapdown strapdown;
    NavigatedState state = over_gale();
    strapdown.start(state);
    const Vector3 hold = -free_acceleration(state.p_MoB_M, Vector3::Zero()) * imu_period_s;
    const Vector3 with_mars(0.0, 0.0, mars_spin_rps * imu_period_s);
    for (std::uint32_t i = 1; i <= 200 * 60; ++i) strapdown.on(parameters, sample(i, hold, with_mars), true);
    CHECK((strapdown.state().p_MoB_M - state.p_MoB_M).norm() < 5e-3);
    CHECK(strapdown.state().v_MB_M.norm() < 1e-4);
    CHECK(strapdown.state().q_MB.angularDistance(state.q_MB) < 1e-9);
}

TEST_CASE("an inertially fixed vehicle turns backwards relative to Mars", "[gnc][R27]") {
    Strapdown strapdown;
    strapdown.start(over_gale());
    for (std::uint32_t i = 1; i <= 200 * 100; ++i)
        strapdown.on(parameters, sample(i, Vector3::Zero(), Vector3::Zero()), true);
    const Vector3 x_B_M = strapdown.state().q_MB * Vector3::UnitX();
    CHECK(std::atan2(x_B_M.y(), x_B_M.x()) == Approx(-mars_spin_rps * 100.0).epsilon(1e-6));
}

TEST_CASE("coning at 1 rad/s leaves less than a milliradian in a minute", "[gnc][R27]") {
    // Truth: q(t) = Rz(wt) Ry(0.1): its body rate is constant, so the increments are exact.
    Strapdown strapdown;
    NavigatedState state = over_gale();
    const Quaternion tilt(Eigen::AngleAxisd(0.1, Vector3::UnitY()));
    state.q_MB = tilt;
    strapdown.start(state);
    constexpr double w = 1.0;
    const Vector3 rate_B = tilt.conjugate() * Vector3(0.0, 0.0, w + mars_spin_rps);
    const Vector3 delta_angle = rate_B * imu_period_s;
    for (std::uint32_t i = 1; i <= 200 * 60; ++i)
        strapdown.on(parameters, sample(i, Vector3::Zero(), delta_angle), true);
    const Quaternion truth = Quaternion(Eigen::AngleAxisd(60.0 * w, Vector3::UnitZ())) * tilt;
    CHECK(strapdown.state().q_MB.angularDistance(truth) < 1e-3);
}

TEST_CASE("lost increments are filled, and an IMU that starts late is not", "[gnc][R27]") {
    Strapdown strapdown;
    strapdown.start(over_gale());
    strapdown.on(parameters, sample(1000, Vector3::Zero(), Vector3::Zero()), true);
    CHECK(strapdown.filled() == 0);
    strapdown.on(parameters, sample(1004, Vector3::Zero(), Vector3::Zero()), true);
    CHECK(strapdown.filled() == 3);
    strapdown.coast(1.0);
    strapdown.on(parameters, sample(1300, Vector3::Zero(), Vector3::Zero()), true);
    CHECK(strapdown.filled() == 3);
}

TEST_CASE("what coasts over a gap turns on at its last rate, for there is no torque", "[gnc][R27][R32]") {
    Strapdown felt, coasted;
    const Vector3 delta_angle = Vector3(0.001, 0.21, -0.002) * imu_period_s;  // the spin of 2 rpm
    for (Strapdown* strapdown : {&felt, &coasted}) {
        strapdown->start(over_gale());
        strapdown->on(parameters, sample(1, Vector3::Zero(), delta_angle), true);
    }
    for (std::uint32_t i = 2; i <= 1 + 200 * 40; ++i)
        felt.on(parameters, sample(i, Vector3::Zero(), delta_angle), true);
    coasted.coast(40.0);
    CHECK(coasted.state().q_MB.angularDistance(felt.state().q_MB) < 1e-4);
    CHECK((coasted.state().p_MoB_M - felt.state().p_MoB_M).norm() < 1.0);
}

TEST_CASE("what the accelerometer tells in vacuum is learnt as its bias and taken off in the air", "[gnc][R27]") {
    Strapdown strapdown;
    strapdown.start(over_gale());
    const Vector3 bias(3.0e-4, -2.0e-4, 1.0e-4);
    for (std::uint32_t i = 1; i <= 2000; ++i)
        strapdown.on(parameters, sample(i, bias * imu_period_s, Vector3::Zero()), false);
    CHECK((strapdown.bias_B_mps2() - bias).norm() < 1e-12);
    CHECK(strapdown.specific_force_B_mps2().norm() == 0.0);
    strapdown.on(parameters, sample(2001, (bias + Vector3::UnitX()) * imu_period_s, Vector3::Zero()), true);
    CHECK((strapdown.specific_force_B_mps2() - Vector3::UnitX()).norm() < 1e-9);
}

TEST_CASE("free fall keeps energy and the spin's angular momentum over an hour", "[gnc][R27]") {
    NavigatedState state;
    state.p_MoB_M = {9.0e6, 0.0, 1.0e6};
    state.v_MB_M = {-2000.0, 1500.0, 100.0};
    const auto inertial = [](const NavigatedState& s) {
        return Vector3(s.v_MB_M + Vector3(0, 0, mars_spin_rps).cross(s.p_MoB_M));
    };
    const auto energy = [&](const NavigatedState& s) {
        const double r = s.p_MoB_M.norm(), z = s.p_MoB_M.z() / r, a = mars_equator_radius_m / r;
        return 0.5 * inertial(s).squaredNorm() -
               mars_gm_m3ps2 / r * (1.0 - mars_j2 * a * a * 0.5 * (3.0 * z * z - 1.0));
    };
    const NavigatedState later = propagate(state, 3600.0);
    CHECK(energy(later) == Approx(energy(state)).epsilon(1e-10));
    CHECK(later.p_MoB_M.cross(inertial(later)).z() == Approx(state.p_MoB_M.cross(inertial(state)).z()).epsilon(1e-10));
    const NavigatedState back = propagate(later, -3600.0);
    CHECK((back.p_MoB_M - state.p_MoB_M).norm() < 1.0);
}

TEST_CASE("what navigation believes is moved as a whole: place, velocity, attitude, learnt bias", "[gnc][campaign]") {
    Strapdown strapdown;
    const NavigatedState before = over_gale();
    strapdown.start(before);
    const double half_rad = 0.5e-3;
    strapdown.shift(
        {{1.0, 2.0, 3.0}, {0.1, 0.2, 0.3}, {std::cos(half_rad), std::sin(half_rad), 0.0, 0.0}, {1e-3, 0, 0}});
    CHECK((strapdown.state().p_MoB_M - before.p_MoB_M - Vector3(1.0, 2.0, 3.0)).norm() < 1e-9);
    CHECK((strapdown.state().v_MB_M - Vector3(0.1, 0.2, 0.3)).norm() < 1e-12);
    CHECK(strapdown.state().q_MB.angularDistance(before.q_MB) == Approx(2.0 * half_rad));
    CHECK(strapdown.bias_B_mps2().x() == 1e-3);
}

}  // namespace flight_gnc_strapdown_test
