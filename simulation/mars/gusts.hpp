// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/mars/mars.hpp"
#include "simulation/random.hpp"

#include <array>

namespace aeolis::simulation {

/// Gusts along one vehicle's path: each component is a first-order Gauss–Markov process over the length of air flown.
///
///   u ← a u + σ √(1 − a²) n,   a = exp(−V Δt / L),   n normal
///
/// The deviation so does not depend on the step. All numbers are our assumptions: σ is the scenario's at the ground and
/// falls to zero at 5 km, half of it vertically; L is half the height, within 25 … 500 m. The first component
/// of the Dryden model for gusts near Earth's ground has this form.
class Gusts {
  public:
    Gusts(double deviation_mps, Random random) : deviation_mps_(deviation_mps), random_(random) {}

    bool blow_at(double altitude_m) const { return deviation_mps_ > 0.0 && altitude_m < top_m; }
    /// Advances the gusts by `step_s` of flight at this speed through the air.
    void advance(double altitude_m, double airspeed_mps, double step_s);
    /// [m/s] in M
    Vector3 at(double altitude_m, const Horizon& local) const;

    static constexpr double top_m = 5000.0;

  private:
    double deviation_mps_;
    Random random_;
    bool begun_ = false;
    std::array<double, 3> parts_{};  ///< east, north, up, each of deviation 1
};

}  // namespace aeolis::simulation
