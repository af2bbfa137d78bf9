// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/devices/device_messages.hpp"
#include "simulation/random.hpp"
#include "simulation/scenario.hpp"
#include "simulation/vectors.hpp"

namespace aeolis::simulation {

/// The rover's own inertial measurement unit: it measures the specific force on the rover and its inertial rate.
///
/// Our assumption: it is of the kind of the descent stage's (simulation/sensors/imu.hpp), so that the scenario's
/// deviations of biases, scale errors and noise hold for it too. Its mounting does not matter: ground looks at
/// magnitudes.
class RoverImu {
  public:
    RoverImu(const Dispersions& dispersions, Random random)
        : force_bias_mps2_(dispersions.imu_bias_mps2 * vector3(random.normal3())),
          force_scale_(dispersions.imu_scale_fraction * vector3(random.normal3())),
          rate_bias_rps_(dispersions.gyro_bias_rps * vector3(random.normal3())),
          rate_scale_(dispersions.gyro_scale_fraction * vector3(random.normal3())),
          force_noise_mps2_(dispersions.imu_noise_mps / reading_s),
          rate_noise_rps_(dispersions.gyro_noise_rad / reading_s), noise_(random) {}

    flight::RoverImuReading measure(const Vector3& force_mps2, const Vector3& rate_rps) {
        const Vector3 force = force_mps2 + force_scale_.cwiseProduct(force_mps2) + force_bias_mps2_ +
                              force_noise_mps2_ * vector3(noise_.normal3());
        const Vector3 rate = rate_rps + rate_scale_.cwiseProduct(rate_rps) + rate_bias_rps_ +
                             rate_noise_rps_ * vector3(noise_.normal3());
        return {array3(force), array3(rate)};
    }

  private:
    static constexpr double reading_s = 1.0 / 200.0;  // [facts] IMU

    Vector3 force_bias_mps2_, force_scale_, rate_bias_rps_, rate_scale_;
    double force_noise_mps2_, rate_noise_rps_;
    Random noise_;
};

}  // namespace aeolis::simulation
