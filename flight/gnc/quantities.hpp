// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_vector.hpp"
#include "generated/dictionary_flight.hpp"

// What a decision of GNC looked at, so that it can explain itself. R38
namespace aeolis::flight::gnc {

using flight::Quantity;

/// One condition behind a decision, for its explanation. R38
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

/// A decision is for "now" when every one of its conditions holds; with none it is never.
inline bool all_hold(const Conditions& conditions) {
    for (const Condition& condition : conditions)
        if (!condition.holds) return false;
    return !conditions.empty();
}

}  // namespace aeolis::flight::gnc
