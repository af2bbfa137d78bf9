// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/landing.hpp"

#include <cstdint>
#include <optional>

// True events that are known only afterwards: a change of side of the lift vector, the peak deceleration.
namespace aeolis::simulation {

/// Counts the lift vector's changes of side above 1100 m/s, once the air is felt (0.2 g).
///
/// A change counts when the bank has gone 10° beyond (our assumption: a wobble about zero is no reversal); it is dated
/// at the change itself.
class BankReversals {
  public:
    BankReversals() = default;
    /// Of a flight that has had `count` reversals.
    explicit BankReversals(int count) : count_(count) {}
    int count() const { return count_; }

    /// Call each tick. Returns a reversal that has become certain, named and dated.
    std::optional<TruthEvent> observe(const TruthState& truth, double bank_rad);

  private:
    bool felt_air_ = false;
    int side_ = 0;
    std::optional<TruthEvent> crossing_;
    int count_ = 0;
};

/// The largest sensed acceleration, certain when the acceleration has fallen to seven tenths of it.
class PeakDeceleration {
  public:
    PeakDeceleration() = default;
    /// Of a flight with this peak so far; `passed`: it is certain, and was returned.
    PeakDeceleration(const TruthEvent& so_far, double mps2, bool passed)
        : peak_mps2_(mps2), peak_(so_far), told_(passed) {}

    std::optional<TruthEvent> observe(const TruthState& truth);
    double mps2() const { return peak_mps2_; }
    bool passed() const { return told_; }

  private:
    double peak_mps2_ = 0.0;
    TruthEvent peak_;
    bool told_ = false;
};

/// An event of that name with the time and state of `truth`.
TruthEvent moment(const char* name, const TruthState& truth);

}  // namespace aeolis::simulation
