// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/mars/mars.hpp"
#include "simulation/random.hpp"

#include <array>

namespace aeolis::simulation {

/// Gusts along one vehicle's path: each component is a first-order Gauss–Markov process over the length of air flown.
///
///   u ← a u + √(1 − a²) n,   a = exp(−V Δt / L),   n normal of deviation 1,   gust = σ u
///
/// So the deviation of u is 1 for any step Δt. All numbers are our assumptions. σ is the scenario's value at the ground
/// and falls linearly to zero at 5 km; for the vertical component it is half as large. L is half the altitude, but at
/// least 25 m and at most 500 m. The longitudinal component of the Dryden model for gusts near Earth's ground has this
/// form.
class Gusts {
  public:
    Gusts(double deviation_mps, Random random) : deviation_mps_(deviation_mps), random_(random) {}

    bool blow_at(double altitude_m) const { return deviation_mps_ > 0.0 && altitude_m < top_m; }
    /// Advances the gusts by `step_s` of flight at this speed through the air.
    void advance(double altitude_m, double airspeed_mps, double step_s);
    /// The gust's velocity [m/s], along the axes of M. Valid up to `top_m`; above, its sign would be reversed.
    Vector3 at(double altitude_m, const Horizon& local) const;

    static constexpr double top_m = 5000.0;

  private:
    double deviation_mps_;
    Random random_;
    bool begun_ = false;
    std::array<double, 3> parts_{};  ///< east, north, up, each of deviation 1
};

}  // namespace aeolis::simulation
