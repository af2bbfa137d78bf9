// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "flight/gnc/quantities.hpp"
#include "generated/dictionary_flight.hpp"

#include <cstdint>

// Detects touchdown: the thrust that the stage needs has settled at the weight of the stage alone.
//
//   |T − W| ≤ 0.12 W in each cycle of the last 1.25 s,   W = (mass − rover) · g
//
// In       commanded thrust [N], estimated mass of stage and rover [kg], 64 Hz       Out   conditions of the decision
// Source   [facts] Timeline: "settles at the weight of the descent stage alone for 1–1.5 s"; the tolerance is our
//          assumption: stage with rover weighs 1.8 times as much, drift of the mass estimate is below 2 %
// Valid    while the stage hovers upright at a steady rate
namespace aeolis::flight::gnc::sky_crane {

inline constexpr auto touchdown_cycles = static_cast<std::uint32_t>(parameters.touchdown_settle_s / seconds_per_tick);
inline constexpr double thrust_tolerance = parameters.touchdown_thrust_tolerance;

class TouchdownLogic {
  public:
    /// Conditions of this cycle; touchdown when all hold.
    Conditions on(double thrust_command_N, double mass_kg, double rover_kg);

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(settled_cycles_);
    }

  private:
    std::uint32_t settled_cycles_ = 0;
};

}  // namespace aeolis::flight::gnc::sky_crane
