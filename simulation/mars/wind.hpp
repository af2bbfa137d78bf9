#pragma once

#include "simulation/mars/mars.hpp"
#include "simulation/random.hpp"

namespace aeolis::simulation {

/// Wind over Gale. No measured winds are published for the landing, so all of it is ours: the scenario's steady wind, a
/// case's own constant part, and below 5 km two waves over height for gusts, half as strong. Horizontal everywhere.
class Wind {
  public:
    Wind(double steady_east_mps, double steady_north_mps, double deviation_mps, Random random);

    /// Velocity of the air relative to rotating Mars [m/s] in M, at `p_MoB_M`, whose height is `altitude_m`.
    Vector3 at(const Vector3& p_MoB_M, double altitude_m) const;

  private:
    double east_mps_, north_mps_, gust_mps_;
    double east_phase_rad_, north_phase_rad_;
};

} // namespace aeolis::simulation
