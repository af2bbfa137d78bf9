// SPDX-License-Identifier: Apache-2.0
#include "simulation/sensors/imu.hpp"

#include "simulation/mars/mars.hpp"

namespace aeolis::simulation {

Imu::Imu(const Dispersions& dispersions, Random random, Random mounting)
    : accelerometer_bias_mps2_(dispersions.imu_bias_mps2 * vector3(random.normal3())),
      accelerometer_scale_(dispersions.imu_scale_fraction * vector3(random.normal3())),
      gyro_bias_rps_(dispersions.gyro_bias_rps * vector3(random.normal3())),
      velocity_noise_mps_(dispersions.imu_noise_mps), angle_noise_rad_(dispersions.gyro_noise_rad),
      q_SensorsB_(rotation(dispersions.imu_misalignment_rad * vector3(mounting.normal3()))),
      gyro_scale_(dispersions.gyro_scale_fraction * vector3(mounting.normal3())), noise_(random) {}

void Imu::disperse(const Dispersions& dispersions, Random random, Random mounting) {
    Imu other{dispersions, random, mounting};
    other.delta_v_mps_ = delta_v_mps_;
    other.turned_ = turned_;
    *this = other;
}

void Imu::add_draws(std::vector<Draw>& draws) const {
    add_axes(draws, "imu_bias", "mps2", accelerometer_bias_mps2_);
    add_axes(draws, "imu_scale", "fraction", accelerometer_scale_);
    add_axes(draws, "imu_misalignment", "rad", rotation_vector(q_SensorsB_));
    add_axes(draws, "gyro_bias", "rps", gyro_bias_rps_);
    add_axes(draws, "gyro_scale", "fraction", gyro_scale_);
}

[[gnu::flatten]] void Imu::integrate(const Vector3& specific_force_M, const Quaternion& q_MB_start,
                                     const Quaternion& q_MB_end, double step_s) {
    Quaternion middle{q_MB_start.coeffs() + (q_MB_start.dot(q_MB_end) < 0.0 ? -1.0 : 1.0) * q_MB_end.coeffs()};
    middle.normalize();
    delta_v_mps_ += middle.conjugate() * (specific_force_M * step_s);
    turned_ = turned_ * q_MB_start.conjugate() * rotation({0.0, 0.0, mars_spin_rps * step_s}) * q_MB_end;
}

[[gnu::flatten]] flight::ImuSample Imu::read(std::uint32_t count) {
    flight::ImuSample sample;
    sample.count = count;
    const Vector3 felt_mps = q_SensorsB_ * delta_v_mps_;
    Vector3 delta_v = felt_mps + accelerometer_scale_.cwiseProduct(felt_mps) + accelerometer_bias_mps2_ * reading_s;
    const Vector3 turned_rad = q_SensorsB_ * rotation_vector(turned_);
    Vector3 delta_angle = turned_rad + gyro_scale_.cwiseProduct(turned_rad) + gyro_bias_rps_ * reading_s;
    if (velocity_noise_mps_ > 0.0) delta_v += velocity_noise_mps_ * vector3(noise_.normal3());
    if (angle_noise_rad_ > 0.0) delta_angle += angle_noise_rad_ * vector3(noise_.normal3());
    sample.delta_v_mps = array3(delta_v);
    sample.delta_angle_rad = array3(delta_angle);
    begin_reading();
    return sample;
}

void Imu::begin_reading() {
    delta_v_mps_.setZero();
    turned_.setIdentity();
}

}  // namespace aeolis::simulation
