// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "generated/parameters.hpp"

// Limits bank in range control so that the vehicle is high enough when it reaches the parachute's speed.
//
//   from now on with lift up:   v̇ = −D − g sin γ    γ̇ = (L − (g − v²/r) cos γ)/v    ḣ = v sin γ
//   D = D₀ (v/v₀)² exp((h₀−h)/H), L/D as sensed: no table of the air is used
//   cos(bank) ≥ 1 − 2 (h at the parachute's speed − guard)/band,  −1 … 1
//
// In       navigated and sensed state           Out   altitude [m]; the largest bank [rad]
// Rate     4 Hz in range control: up to 150 steps         Memory   none
// Source   our assumption; in OD137 the predicted altitude stays above guard and band, so bank is not limited
namespace aeolis::flight::gnc {

struct PullUp {
    double altitude_m = 0.0;
    double speed_mps = 0.0;
    double descent_rate_mps = 0.0;
    double drag_mps2 = 0.0;
    double lift_to_drag = 0.0;
};

/// Altitude at which the vehicle reaches `speed_mps` with lift up from now on; if not within the prediction, the
/// altitude at its end.
double altitude_when_slow_m(const Parameters& parameters, const PullUp& now, double speed_mps);

/// The largest bank [rad] for a predicted altitude, 0 … π.
double bank_allowed_rad(const Parameters& parameters, double altitude_foreseen_m);

}  // namespace aeolis::flight::gnc
