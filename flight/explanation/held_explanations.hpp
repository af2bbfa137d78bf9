// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/explanation/explanation.hpp"
#include "flight/kernel/outbox.hpp"

#include <array>

namespace aeolis::flight {

/// Reports decisions that are near but held, at a limited rate, because a decision is held in every cycle. R38
///
/// In       a decision that is held in this cycle, with its conditions          Out   Explanation, verdict held
/// Limit    once in 4 s for a decision (chosen: the console shows one for 5 s), two a second over all decisions
///          (chosen: a quarter of the 8 kb/s link). Suppressed explanations are counted, and the next one of the
///          decision and its subject gives the count
/// Memory   fixed; one subject a decision, whose count stays until it is reported or another subject is held
class HeldExplanations {
  public:
    static constexpr double again_after_s = 4.0;
    static constexpr std::uint32_t each_second_max = 2;

    /// Reports a held decision.
    /// `subject` tells apart subjects of one kind of decision: a new subject is reported at once.
    void held(Decision decision, std::uint16_t subject, std::span<const gnc::Condition> conditions, Outbox& out);

    /// The decision was made: returns and clears the number of explanations suppressed since the last.
    std::uint16_t take_suppressed(Decision decision);

  private:
    struct LastSent {
        MaybeTime when;
        std::uint16_t subject = 0;
        std::uint16_t suppressed = 0;
    };
    static constexpr std::size_t decisions_max = 64;  // chosen: three times the dictionary's; checked
    LastSent& of(Decision decision);

    std::array<LastSent, decisions_max> told_{};
    Sclk second_;
    std::uint32_t told_in_second_ = 0;
};

}  // namespace aeolis::flight
