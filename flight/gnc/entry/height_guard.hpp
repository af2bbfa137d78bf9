// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "generated/parameters.hpp"

// Height before range: how far from lift up range control may bank without coming to the parachute's speed too low.
//
//   from now on with lift up:   v̇ = −D − g sin γ    γ̇ = (L − (g − v²/r) cos γ)/v    ḣ = v sin γ
//   D = D₀ (v/v₀)² exp((h₀−h)/H), L/D as sensed: no table of the air is asked
//   cos(bank) ≥ 1 − 2 (h at the parachute's speed − guard)/band,  −1 … 1
//
// In       what is navigated and sensed now           Out   altitude [m]; the largest bank [rad]
// Rate     4 Hz in range control: up to 150 steps         Memory   none
// Source   ours; in OD137 the altitude foreseen stays above guard and band, and nothing is limited
namespace aeolis::flight::gnc {

struct PullUp {
    double altitude_m = 0.0;
    double speed_mps = 0.0;
    double descent_rate_mps = 0.0;
    double drag_mps2 = 0.0;
    double lift_to_drag = 0.0;
};

/// Where the vehicle comes to `speed_mps` when its lift is up from now on; where it then is if it does not within the foresight.
double altitude_when_slow_m(const Parameters& parameters, const PullUp& now, double speed_mps);

/// The largest bank for an altitude foreseen. 0 … π
double bank_allowed_rad(const Parameters& parameters, double altitude_foreseen_m);

}  // namespace aeolis::flight::gnc
