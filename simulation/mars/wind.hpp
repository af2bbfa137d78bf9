// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/mars/gusts.hpp"
#include "simulation/mars/mars.hpp"
#include "simulation/random.hpp"
#include "simulation/scenario.hpp"

#include <span>
#include <vector>

namespace aeolis::simulation {

/// Wind over Gale: steady wind, a case's own constant part, shear, and gusts.
///
/// No measured winds are published for the landing, so all of it is our assumption. The steady wind and its table by
/// height are the scenario's.
/// Shear, below 5 km, is two waves over height, half as strong as the case's part. These are horizontal everywhere.
/// Gusts change along the flight.
class Wind {
  public:
    Wind(double steady_east_mps, double steady_north_mps, double deviation_mps, Random random, const Gusts& gusts,
         std::span<const WindRow> by_height = {});

    /// Velocity of the air relative to rotating Mars [m/s] in M, at `p_MoB_M`, which has the height `altitude_m`.
    Vector3 at(const Vector3& p_MoB_M, double altitude_m) const;

    /// Steady wind and the case's own part, at all heights.
    double east_mps() const { return east_mps_; }
    double north_mps() const { return north_mps_; }

    /// From now on added at all heights.
    void shift(double east_mps, double north_mps) { shift_east_mps_ = east_mps, shift_north_mps_ = north_mps; }

    /// Advances the gusts by `step_s` of flight at this position and velocity.
    void advance(const Vector3& p_MoB_M, const Vector3& v_MB_M, double altitude_m, double step_s) {
        if (gusts_.blow_at(altitude_m)) gusts_.advance(altitude_m, (v_MB_M - at(p_MoB_M, altitude_m)).norm(), step_s);
    }

  private:
    double east_mps_, north_mps_, wave_mps_;
    double east_phase_rad_, north_phase_rad_;
    double shift_east_mps_ = 0.0, shift_north_mps_ = 0.0;
    std::vector<WindRow> by_height_;
    Gusts gusts_;
};

}  // namespace aeolis::simulation
