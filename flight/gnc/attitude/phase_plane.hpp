// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

// The phase plane of one axis: from the angle still to turn to the wanted rate.
//
//   |ω| = min( ω_max, √(2 · b · a · (|θ| − δ)), k · (|θ| − δ) ),   0 inside the deadband |θ| ≤ δ
//
// On the parabola, the part b of the available deceleration suffices to stop in time. Near the end the rate decreases
// proportionally, so that a thruster's minimum impulse does not cause a limit cycle.
//
// In       θ [rad] still to turn, signed                    Out   rate [rad/s], towards θ
// Source   [wie-1998] (switching curve of a double integrator); the reserve and the proportional end
//          are our assumption
namespace aeolis::flight::gnc {

struct TurnLimits {
    double rate_rps = 0.0;
    double acceleration_rps2 = 0.0;
    double deadband_rad = 0.0;
    double gain_per_s = 0.0;        ///< k
    double braking_fraction = 0.0;  ///< b
};

inline double rate_to_turn(double angle_rad, const TurnLimits& limits) {
    const double left_rad = std::abs(angle_rad) - limits.deadband_rad;
    if (left_rad <= 0.0) return 0.0;
    const double stoppable_rps = std::sqrt(2.0 * limits.braking_fraction * limits.acceleration_rps2 * left_rad);
    return std::copysign(std::min({limits.rate_rps, stoppable_rps, limits.gain_per_s * left_rad}), angle_rad);
}

}  // namespace aeolis::flight::gnc
