// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_vector.hpp"
#include "generated/dictionary_flight.hpp"

#include <span>

// Quantities and conditions behind a decision of GNC, for its explanation. R38
namespace aeolis::flight::gnc {

using flight::Quantity;

/// One condition behind a decision, with the value compared and its bound. R38
struct Condition {
    Quantity quantity = Quantity::none;
    double value = 0.0;
    double bound = 0.0;
    using Comparison = flight::Comparison;
    Comparison comparison{};
    bool holds = false;
};

constexpr Condition at_most(Quantity quantity, double value, double bound) {
    return {quantity, value, bound, Condition::Comparison::le, value <= bound};
}
constexpr Condition at_least(Quantity quantity, double value, double bound) {
    return {quantity, value, bound, Condition::Comparison::ge, value >= bound};
}
constexpr Condition below(Quantity quantity, double value, double bound) {
    return {quantity, value, bound, Condition::Comparison::lt, value < bound};
}
constexpr Condition above(Quantity quantity, double value, double bound) {
    return {quantity, value, bound, Condition::Comparison::gt, value > bound};
}
/// A fact that must be `wanted`.
constexpr Condition is(Quantity quantity, bool fact, bool wanted = true) {
    return {quantity, fact ? 1.0 : 0.0, wanted ? 1.0 : 0.0, Condition::Comparison::eq, fact == wanted};
}
/// Names something by its number: a tone, a mode, an event. Not a comparison of amounts.
constexpr Condition names(Quantity quantity, double number) {
    return {quantity, number, number, Condition::Comparison::eq, true};
}

using Conditions = FixedVector<Condition, 4>;

/// Selects the four most informative conditions: first those that do not hold, then others, each in order.
constexpr Conditions telling(std::span<const Condition> conditions) {
    Conditions told;
    for (const bool holds : {false, true})
        for (const Condition& condition : conditions)
            if (condition.holds == holds) static_cast<void>(told.try_push_back(condition));
    return told;
}

/// Whether a decision is due: all of its conditions hold. False when there are none.
constexpr bool all_hold(std::span<const Condition> conditions) {
    for (const Condition& condition : conditions)
        if (!condition.holds) return false;
    return !conditions.empty();
}

}  // namespace aeolis::flight::gnc
