// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/devices/device_messages.hpp"
#include "simulation/draws.hpp"
#include "simulation/random.hpp"
#include "simulation/scenario.hpp"
#include "simulation/vectors.hpp"

namespace aeolis::simulation {

/// The inertial measurement unit: integrates specific force and inertial rate in B, one reading each 5 ms.
///
/// Each accelerometer and gyro has a constant bias, a constant scale error and noise on each reading, with the
/// scenario's deviations. A small rotation, the same for all sensors, misaligns their axes from those of B, with the
/// scenario's deviation about each axis. The unit sits at the centre of mass.
class Imu {
  public:
    static constexpr double reading_s = 1.0 / 200.0;  // [facts]

    /// `mounting` draws the misalignment and the gyros' scale errors.
    Imu(const Dispersions& dispersions, Random random, Random mounting);

    /// Draws the errors anew; the reading under way is kept.
    void disperse(const Dispersions& dispersions, Random random, Random mounting);
    const Vector3& accelerometer_bias_mps2() const { return accelerometer_bias_mps2_; }
    void add_draws(std::vector<Draw>& draws) const;

    /// Adds a step's motion: mean specific force in M, turned by the middle attitude, and attitudes at both ends.
    void integrate(const Vector3& specific_force_M_mps2, const Quaternion& q_MB_start, const Quaternion& q_MB_end,
                   double step_s);
    /// Ends the reading and begins the next. `count`: its number since the unit was started.
    flight::ImuSample read(std::uint32_t count);
    /// Discards the reading under way and begins a new one.
    void begin_reading();

  private:
    Vector3 accelerometer_bias_mps2_, accelerometer_scale_, gyro_bias_rps_;
    double velocity_noise_mps_, angle_noise_rad_;
    Quaternion q_SensorsB_;  ///< turns components in B into components along the sensors' axes
    Vector3 gyro_scale_;
    Random noise_;
    Vector3 delta_v_mps_ = Vector3::Zero();
    Quaternion turned_ = Quaternion::Identity();  ///< rotation since the last reading, relative to inertial space
};

}  // namespace aeolis::simulation
