#pragma once

#include "flight/gnc/quantities.hpp"
#include "generated/dictionary_flight.hpp"

#include <cstdint>
#include <span>

namespace aeolis::flight {

/// What a decision looked at, for its explanation. Quantities that GNC does not know are those of the dictionary.
constexpr gnc::Condition condition(Quantity quantity, double value, gnc::Condition::Comparison comparison, double bound,
                                   bool holds) {
    return {static_cast<std::uint16_t>(quantity), value, bound, comparison, holds};
}
constexpr gnc::Condition at_most(Quantity quantity, double value, double bound) {
    return condition(quantity, value, gnc::Condition::Comparison::le, bound, value <= bound);
}
constexpr gnc::Condition at_least(Quantity quantity, double value, double bound) {
    return condition(quantity, value, gnc::Condition::Comparison::ge, bound, value >= bound);
}
constexpr gnc::Condition below(Quantity quantity, double value, double bound) {
    return condition(quantity, value, gnc::Condition::Comparison::lt, bound, value < bound);
}
constexpr gnc::Condition above(Quantity quantity, double value, double bound) {
    return condition(quantity, value, gnc::Condition::Comparison::gt, bound, value > bound);
}
/// Which tone: a name, not an amount.
constexpr gnc::Condition is_tone(Quantity quantity, ToneId tone) {
    return condition(quantity, tone.value, gnc::Condition::Comparison::eq, tone.value, true);
}

/// The packet that tells ground of a decision and its conditions; it has places for four. R38
packet::Explanation explanation(Decision decision, ExplanationVerdict verdict, std::uint16_t subject,
                                std::span<const gnc::Condition> conditions, std::uint16_t suppressed = 0);

}  // namespace aeolis::flight
