// SPDX-License-Identifier: Apache-2.0
#include "flight/explanation/explanation.hpp"

namespace aeolis::flight {

packet::Explanation explanation(Decision decision, ExplanationVerdict verdict, std::uint16_t subject,
                                std::span<const gnc::Condition> conditions, std::uint16_t suppressed) {
    packet::Explanation e{.decision = decision,
                          .verdict = verdict,
                          .subject = subject,
                          .condition_count = static_cast<std::uint8_t>(conditions.size()),
                          .suppressed = suppressed};
    const auto put = [&](std::size_t i, bool& holds, Quantity& quantity, double& value, double& bound,
                         Comparison& comparison) {
        if (i >= conditions.size()) return;
        const gnc::Condition& c = conditions[i];
        holds = c.holds;
        quantity = c.quantity;
        value = c.value;
        bound = c.bound;
        comparison = c.comparison;
    };
    put(0, e.holds_1, e.condition_1, e.value_1, e.bound_1, e.comparison_1);
    put(1, e.holds_2, e.condition_2, e.value_2, e.bound_2, e.comparison_2);
    put(2, e.holds_3, e.condition_3, e.value_3, e.bound_3, e.comparison_3);
    put(3, e.holds_4, e.condition_4, e.value_4, e.bound_4, e.comparison_4);
    return e;
}

}  // namespace aeolis::flight
