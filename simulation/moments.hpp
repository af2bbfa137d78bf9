// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/landing.hpp"

#include <cstdint>
#include <optional>

// Moments of the truth that only show afterwards: a lift vector that changed sides, a deceleration that was the
// largest.
namespace aeolis::simulation {

/// Counts the lift vector's changes of side above 1100 m/s, from the moment when air is first felt (0.2 g).
/// A change counts once the bank has gone 10° beyond (ours: so that a wobble about zero is no reversal); its moment is
/// that of the change itself.
class BankReversals {
  public:
    /// Each tick. Returns a reversal that is now certain, named and dated.
    std::optional<TruthEvent> observe(const TruthState& truth, double bank_rad);

  private:
    bool felt_air_ = false;
    int side_ = 0;
    std::optional<TruthEvent> crossing_;
    int count_ = 0;
};

/// The largest sensed acceleration, certain once what is sensed has fallen to seven tenths of it.
class PeakDeceleration {
  public:
    std::optional<TruthEvent> observe(const TruthState& truth);
    double mps2() const { return peak_mps2_; }

  private:
    double peak_mps2_ = 0.0;
    TruthEvent peak_;
    bool told_ = false;
};

/// `truth` as an event of that name.
TruthEvent moment(const char* name, const TruthState& truth);

}  // namespace aeolis::simulation
