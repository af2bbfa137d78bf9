// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/vector.hpp"
#include "generated/parameters.hpp"

// Flies the stage away from the rover after the bridle is cut, so that it falls at a distance.
//
//   0 … 0.2 s   thrust equal to the stage's weight, upright: clear of the rover
//   … 2.0 s     full thrust, upright
//   … end       full thrust, pitched from upright to 45° in 1.5 s, towards an azimuth; the timeline stops the engines
//
// In       time since fly-away began [s], position
// Out      wanted direction of thrust in M, and whether thrust is full or equal to the stage's weight
// Source   [facts] Timeline: burn of 6.66 s, stage falls ≥ 450 m away; phases, pitch and azimuth (north) are our
//          assumption
namespace aeolis::flight::gnc::flyaway {

struct Command {
    Vector3 direction_M = Vector3::UnitX();  ///< unit, of thrust
    bool full = false;                       ///< false: thrust equals the stage's weight
};

Command command(const Parameters& parameters, double since_start_s, const Vector3& p_MoB_M);

}  // namespace aeolis::flight::gnc::flyaway
