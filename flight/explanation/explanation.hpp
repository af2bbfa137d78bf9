// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/quantities.hpp"
#include "generated/dictionary_flight.hpp"

#include <cstdint>
#include <span>

namespace aeolis::flight {

// What a decision looked at; whoever decides outside GNC says it in the same words.
using gnc::at_least;
using gnc::at_most;
using gnc::below;
constexpr gnc::Condition above(Quantity quantity, double value, double bound) {
    return {quantity, value, bound, Comparison::gt, value > bound};
}
constexpr gnc::Condition is(Quantity quantity, double value, double bound) {
    return {quantity, value, bound, Comparison::eq, value == bound};
}
/// Which tone: a name, not an amount.
constexpr gnc::Condition is_tone(Quantity quantity, ToneId tone) {
    return is(quantity, tone.value, tone.value);
}

/// The packet that tells ground of a decision and its conditions; it has places for four. R38
packet::Explanation explanation(Decision decision, ExplanationVerdict verdict, std::uint16_t subject,
                                std::span<const gnc::Condition> conditions, std::uint16_t suppressed = 0);

}  // namespace aeolis::flight
