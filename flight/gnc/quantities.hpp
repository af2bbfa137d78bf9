// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_vector.hpp"
#include "generated/dictionary_flight.hpp"

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

using Conditions = FixedVector<Condition, 4>;

/// Whether a decision is due: all of its conditions hold. False when there are none.
inline bool all_hold(const Conditions& conditions) {
    for (const Condition& condition : conditions)
        if (!condition.holds) return false;
    return !conditions.empty();
}

}  // namespace aeolis::flight::gnc
