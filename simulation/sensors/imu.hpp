#pragma once

#include "flight/devices/device_messages.hpp"
#include "simulation/random.hpp"
#include "simulation/scenario.hpp"
#include "simulation/vectors.hpp"

namespace aeolis::simulation {

/// The inertial measurement unit: integrates specific force and inertial rate in B, one reading each 5 ms.
///
/// Constant bias of the scenario's deviation on each axis; scale error and noise are ours, in proportion to the bias so
/// that a deviation of zero makes the unit perfect: at the default 3.3e-4 m/s² a scale of 1e-4 and 5e-5 m/s of noise a
/// reading (1 σ), at 8e-8 rad/s 2e-6 rad of noise a reading. Its axes are turned away from those of B by a small rotation, the
/// same for all its sensors, of the scenario's deviation about each axis. It sits at the centre of mass.
class Imu {
  public:
    /// `mounting` draws how it is turned.
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
    Quaternion q_SensorsB_; ///< turns components in B into those along the sensors' axes
    Random noise_;
    Vector3 delta_v_mps_ = Vector3::Zero();
    Quaternion turned_ = Quaternion::Identity(); ///< since the last reading, relative to inertial space
};

} // namespace aeolis::simulation
