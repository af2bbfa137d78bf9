// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"

#include <cstdint>
#include <optional>

// Which side the lift points to: bank reverses when the target has left a deadband on the side away from the lift.
//
//   reverse when  sign · crossrange < −deadband(V);  deadband = b0 + b2 V², halved when lift is saturated
//   and not sooner than a least time after the last reversal
//
// In       crossrange of the target, positive to the right; V            Out   sign of bank, number of reversals
// Source   [apollo-entry-guidance] for a deadband that shrinks with velocity and is halved at saturation. Its numbers
//          are ours, read off [od137]: it began its first reversal at 4 km of crossrange, its third at 2.4 km (tuned
//          from there to its times); the second came only at 10 km, and the least time is what was between the first
//          and it
namespace aeolis::flight::gnc {

/// Half width of the deadband [m] at a velocity.
double crossrange_deadband_m(double velocity_mps, bool saturated);

class LateralLogic {
  public:
    /// True in the cycle in which a reversal begins. `settled`: the vehicle has reached the side commanded before.
    bool on(Sclk now, double crossrange_m, double velocity_mps, bool saturated, bool settled);

    void start(int sign) { sign_ = sign; }
    int sign() const { return sign_; }  ///< +1: lift to the right
    std::uint8_t reversals() const { return reversals_; }

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(sign_, reversals_, reversed_at_);
    }

  private:
    int sign_ = 1;
    std::uint8_t reversals_ = 0;
    std::optional<Sclk> reversed_at_;
};

}  // namespace aeolis::flight::gnc
