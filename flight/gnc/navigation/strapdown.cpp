// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/navigation/strapdown.hpp"

#include "flight/gnc/mars.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace aeolis::flight::gnc {

namespace {

/// The rotation by a small vector, to third order; the caller keeps the angle below 0.1 rad.
Quaternion small_rotation(const Vector3& angle) {
    const double half_squared = 0.25 * angle.squaredNorm();
    const double s = 0.5 * (1.0 - half_squared / 6.0);
    return {1.0 - 0.5 * half_squared, s * angle.x(), s * angle.y(), s * angle.z()};
}

Quaternion rotation(const Vector3& angle) {
    const double angle_rad = angle.norm();
    return angle_rad > 0.0 ? Quaternion{Eigen::AngleAxisd{angle_rad, angle / angle_rad}} : Quaternion::Identity();
}

}  // namespace

void Strapdown::shift(const NavigationShift& by) {
    correct(to_vector(by.p_MoB_M_m), to_vector(by.v_MB_M_mps));
    state_.q_MB = (state_.q_MB * to_quaternion(by.q_BB)).normalized();
    bias_B_mps2_ += to_vector(by.accelerometer_bias_mps2);
}

[[gnu::flatten]] void Strapdown::step(const Vector3& delta_angle_B, const Vector3& delta_v_B, double dt_s) {
    // Over the step the frame turns by Δθ; on average half of it applies while Δv is sensed.
    const Vector3 delta_v_M = state_.q_MB * (delta_v_B + 0.5 * delta_angle_B.cross(delta_v_B));
    const Vector3 v_before = state_.v_MB_M;
    const Vector3 p_half_M = state_.p_MoB_M + 0.5 * dt_s * v_before;
    state_.v_MB_M += delta_v_M + dt_s * free_acceleration(p_half_M, v_before);
    if (gravity_fraction_ != 0.0) state_.v_MB_M += dt_s * local_gravity(p_half_M, gravity_fraction_);
    state_.p_MoB_M += 0.5 * dt_s * (v_before + state_.v_MB_M);
    const Quaternion mars_turns = small_rotation({0.0, 0.0, -mars_spin_rps * dt_s});
    state_.q_MB = mars_turns * state_.q_MB * small_rotation(delta_angle_B);
    // One Newton step towards unit norm: exact to 1e-16 for norms this close to one, without a square root.
    state_.q_MB.coeffs() *= 1.5 - 0.5 * state_.q_MB.squaredNorm();  // NOLINT(readability-magic-numbers)
}

void Strapdown::on(const Parameters& parameters, const ImuSample& sample, bool force_felt) {
    const Vector3 delta_angle_B = to_vector(sample.delta_angle_rad);
    const Vector3 raw_force_B = to_vector(sample.delta_v_mps) / imu_period_s;
    if (!force_felt) {
        bias_samples_ = std::min(bias_samples_ + 1, static_cast<std::uint32_t>(parameters.imu_bias_samples_max));
        bias_B_mps2_ += (raw_force_B - bias_B_mps2_) / static_cast<double>(bias_samples_);
    }
    const Vector3 force_B = force_felt ? Vector3(raw_force_B - bias_B_mps2_) : Vector3(Vector3::Zero());
    if (counting_) fill(sample.count - last_count_ - 1);
    counting_ = true;
    reckoned_s_ = 0.0;
    last_count_ = sample.count;
    rate_B_rps_ = delta_angle_B / imu_period_s;
    specific_force_B_mps2_ = force_B;
    step(delta_angle_B, force_B * imu_period_s, imu_period_s);
}

// Whole ticks were estimated, and an increment lasts a third of a tick. So the time that is missing, or was estimated
// twice, is less than two increments.
void Strapdown::fill(std::uint32_t missing) {
    if (reckoned_s_ > 0.0) {
        const double left_s = missing * imu_period_s - reckoned_s_;
        if (std::abs(left_s) <= 2.0 * seconds_per_tick)
            step(rate_B_rps_ * left_s, specific_force_B_mps2_ * left_s, left_s);
        return;
    }
    for (std::uint32_t i = 0; i < std::min(missing, gap_max); ++i) {
        step(rate_B_rps_ * imu_period_s, specific_force_B_mps2_ * imu_period_s, imu_period_s);
        ++filled_;
    }
}

void Strapdown::reckon(const Vector3& force_B_mps2, const Vector3& rate_B_rps, double dt_s) {
    rate_B_rps_ = rate_B_rps;
    specific_force_B_mps2_ = force_B_mps2;
    step(rate_B_rps * dt_s, force_B_mps2 * dt_s, dt_s);
    reckoned_s_ += dt_s;
}

void Strapdown::turn(const Vector3& angle_M_rad) {
    const Quaternion turned = small_rotation(angle_M_rad);
    state_.q_MB = (turned * state_.q_MB).normalized();
    state_.v_MB_M = turned * state_.v_MB_M;
}

void Strapdown::coast(double dt_s) {
    state_.q_MB = state_.q_MB * rotation(rate_B_rps_ * dt_s);  // without torque it turns on
    state_ = propagate(state_, dt_s);
    reckoned_s_ = 0.0;
    counting_ = false;  // increments of this time, if they still arrive, were coasted over
}

NavigatedState propagate(const NavigatedState& state, double seconds) {
    NavigatedState now = state;
    const auto steps = static_cast<std::int64_t>(std::max(1.0, std::ceil(std::abs(seconds))));
    const double dt = seconds / static_cast<double>(steps);
    for (std::int64_t i = 0; i < steps; ++i) fall(now.p_MoB_M, now.v_MB_M, dt);
    const double half = -0.5 * mars_spin_rps * seconds;
    now.q_MB = (Quaternion(std::cos(half), 0.0, 0.0, std::sin(half)) * state.q_MB).normalized();
    return now;
}

}  // namespace aeolis::flight::gnc
