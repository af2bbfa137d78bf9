// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/devices/device_messages.hpp"
#include "simulation/random.hpp"
#include "simulation/scenario.hpp"
#include "simulation/vectors.hpp"

namespace aeolis::simulation {

/// The inertial measurement unit: integrates specific force and inertial rate in B, one reading each 5 ms.
///
/// Each axis of either kind has a constant bias, a constant scale error and noise from reading to reading, of the
/// scenario's deviations. Its axes are turned away from those of B by a small rotation, the same for all its sensors,
/// of the scenario's deviation about each axis. It sits at the centre of mass.
class Imu {
  public:
    /// `mounting` draws how it is turned, and the gyros' scale.
    Imu(const Dispersions& dispersions, Random random, Random mounting);

    /// Other errors from here on; what it has integrated of a reading stays.
    void disperse(const Dispersions& dispersions, Random random, Random mounting);
    const Vector3& accelerometer_bias_mps2() const { return accelerometer_bias_mps2_; }

    /// Adds what happened in a step: mean specific force in M with the attitude in its middle, and attitudes at its
    /// ends.
    void integrate(const Vector3& specific_force_M_mps2, const Quaternion& q_MB_start, const Quaternion& q_MB_end,
                   double step_s);
    /// The reading that ends here; the next begins. `count` is its number since the unit was started.
    flight::ImuSample read(std::uint32_t count);
    /// Forgets what it has integrated of a reading: nobody listened when it began.
    void begin_reading();

  private:
    Vector3 accelerometer_bias_mps2_, accelerometer_scale_, gyro_bias_rps_;
    double velocity_noise_mps_, angle_noise_rad_;
    Quaternion q_SensorsB_;  ///< turns components in B into those along the sensors' axes
    Vector3 gyro_scale_;
    Random noise_;
    Vector3 delta_v_mps_ = Vector3::Zero();
    Quaternion turned_ = Quaternion::Identity();  ///< since the last reading, relative to inertial space
};

}  // namespace aeolis::simulation
