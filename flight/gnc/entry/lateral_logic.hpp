// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "flight/gnc/quantities.hpp"
#include "generated/parameters.hpp"

#include <cstdint>
#include <optional>

// Lateral logic: reverses bank when the target leaves a deadband on the side away from the lift.
//
//   reverse when  sign · crossrange < −deadband(V);  deadband = b0 + b2 V², halved when lift is saturated
//   and not sooner than a least time after the last reversal
//
// In       crossrange of the target, positive to the right; V            Out   sign of bank, number of reversals
// Source   [apollo-entry-guidance] for a deadband that shrinks with velocity and is halved at saturation. Its numbers
//          are our assumption, read off [od137]: its first reversal began at 4 km of crossrange, its third at 2.4 km
//          (tuned from there to its times). The second began only at 10 km; the least time is the interval from the
//          first to the second
namespace aeolis::flight::gnc {

/// Half width of the deadband [m] at a velocity.
double crossrange_deadband_m(const Parameters& parameters, double velocity_mps, bool saturated);

class LateralLogic {
  public:
    /// Updates the logic, and returns its conditions: where all hold, a reversal begins in this cycle. R38
    /// `settled`: that the commanded side has been reached.
    Conditions on(const Parameters& parameters, Sclk now, double crossrange_m, double velocity_mps, bool saturated,
                  const Condition& settled);

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
