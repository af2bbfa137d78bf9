// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "flight/gnc/quantities.hpp"
#include "generated/parameters.hpp"

#include <cstdint>

// Detects touchdown: the rover stands on the ground once the commanded thrust T has settled at the weight W of the
// descent stage alone.
//
//   |T − W| ≤ 0.12 W in each cycle of the last 1.25 s,   W = (mass − rover's mass) · g
//
// In       at 64 Hz: commanded thrust [N], estimated mass of stage and rover [kg], the rover's mass [kg]
// Out      conditions of the decision
// Source   [facts] Timeline: "settles at the weight of the descent stage alone for 1–1.5 s". The tolerance is our
//          assumption: far below the step at touchdown (with the rover the stage weighs 1.8 times as much), and well
//          above the drift of the mass estimate (below 2 %)
// Valid    while the stage is upright and its descent rate is steady
namespace aeolis::flight::gnc::sky_crane {

class TouchdownLogic {
  public:
    /// Call once a cycle. Touchdown is detected in the cycle in which all conditions returned hold.
    Conditions on(const Parameters& parameters, double thrust_command_N, double mass_kg, double rover_kg);

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(settled_cycles_);
    }

  private:
    std::uint32_t settled_cycles_ = 0;
};

}  // namespace aeolis::flight::gnc::sky_crane
