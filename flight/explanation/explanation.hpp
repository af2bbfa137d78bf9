// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/quantities.hpp"
#include "generated/dictionary_flight.hpp"

#include <cstdint>
#include <span>

namespace aeolis::flight {

// Conditions behind a decision; deciders outside GNC use the same functions.
using gnc::at_least;
using gnc::at_most;
using gnc::below;
constexpr gnc::Condition above(Quantity quantity, double value, double bound) {
    return {quantity, value, bound, Comparison::gt, value > bound};
}
constexpr gnc::Condition is(Quantity quantity, double value, double bound) {
    return {quantity, value, bound, Comparison::eq, value == bound};
}
/// Names a tone; not a comparison of amounts.
constexpr gnc::Condition is_tone(Quantity quantity, ToneId tone) {
    return is(quantity, tone.value, tone.value);
}

/// The packet that explains a decision by its conditions, at most four. R38
packet::Explanation explanation(Decision decision, ExplanationVerdict verdict, std::uint16_t subject,
                                std::span<const gnc::Condition> conditions, std::uint16_t suppressed = 0);

}  // namespace aeolis::flight
