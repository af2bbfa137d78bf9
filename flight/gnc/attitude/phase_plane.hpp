// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

// The phase plane of one axis: from how far it is to turn to how fast it should be turning now.
//
//   |ω| = min( ω_max, √(2 · 0.7 · a · (|θ| − δ)), k · (|θ| − δ) ),   0 inside the deadband |θ| ≤ δ
//
// The parabola is the line on which seven tenths of the deceleration still stop it in time; near the end the rate falls
// off in proportion, so that a thruster's least impulse does not make it hunt.
//
// In       θ [rad] still to turn, signed                    Out   rate [rad/s], towards θ
// Source   [wie-1998] (switching curve of a double integrator); the reserve of three tenths and the shape at its end
//          are ours
namespace aeolis::flight::gnc {

struct TurnLimits {
    double rate_rps = 0.0;
    double acceleration_rps2 = 0.0;
    double deadband_rad = 0.0;
    double gain_per_s = 0.0;  ///< k
};

inline double rate_to_turn(double angle_rad, const TurnLimits& limits) {
    const double left_rad = std::abs(angle_rad) - limits.deadband_rad;
    if (left_rad <= 0.0) return 0.0;
    const double stoppable_rps = std::sqrt(2.0 * 0.7 * limits.acceleration_rps2 * left_rad);
    return std::copysign(std::min({limits.rate_rps, stoppable_rps, limits.gain_per_s * left_rad}), angle_rad);
}

}  // namespace aeolis::flight::gnc
