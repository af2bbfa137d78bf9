// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/explanation/explanation.hpp"
#include "flight/kernel/outbox.hpp"

#include <array>

namespace aeolis::flight {

/// Tells ground of decisions that are near and held, without flooding the link: they stand in every cycle. R38
///
/// In       a decision that is held in this cycle, with its conditions          Out   Explanation, verdict held
/// Limit    once in 4 s for a decision (ours: the console shows one for 5 s), two a second over all decisions (ours: a
///          quarter of the 8 kb/s link); what is not told is counted, and the decision's next explanation says how
///          often
/// Memory   fixed; a decision's count stands until it is told
class HeldExplanations {
  public:
    static constexpr double again_after_s = 4.0;
    static constexpr std::uint32_t each_second_max = 2;

    /// `subject` tells apart what one kind of decision is about: another one is told at once.
    void held(Decision decision, std::uint16_t subject, std::span<const gnc::Condition> conditions, Outbox& out);

    /// The decision was made: how many of its explanations were not told since the last, for this one to say.
    std::uint16_t take_suppressed(Decision decision);

  private:
    struct Told {
        MaybeTime when;
        std::uint16_t subject = 0;
        std::uint16_t suppressed = 0;
    };
    static constexpr std::size_t decisions_max = 64;  // ours: three times the dictionary's; a check holds us to it
    Told& of(Decision decision);

    std::array<Told, decisions_max> told_{};
    Sclk second_;
    std::uint32_t told_in_second_ = 0;
};

}  // namespace aeolis::flight
