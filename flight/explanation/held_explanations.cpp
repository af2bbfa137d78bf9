// SPDX-License-Identifier: Apache-2.0
#include "flight/explanation/held_explanations.hpp"

#include <limits>
#include <utility>

namespace aeolis::flight {

HeldExplanations::LastSent& HeldExplanations::of(Decision decision) {
    const auto index = static_cast<std::size_t>(decision);
    AEOLIS_CHECK(index < decisions_max);
    return told_[index];
}

void HeldExplanations::held(Decision decision, std::uint16_t subject, std::span<const gnc::Condition> conditions,
                            Outbox& out) {
    const Sclk now = out.now();
    if (const Sclk second = at_resolution(now, 1); second != second_) {
        second_ = second;
        told_in_second_ = 0;
    }
    LastSent& told = of(decision);
    if (told.subject != subject) told = {MaybeTime{}, subject, 0};
    const bool told_lately = told.when.defined() && now - *told.when.get() < again_after_s;
    if (told_lately || told_in_second_ == each_second_max) {
        if (told.suppressed < std::numeric_limits<std::uint16_t>::max()) ++told.suppressed;
        return;
    }
    ++told_in_second_;
    out.record(explanation(decision, ExplanationVerdict::held, subject, conditions, take_suppressed(decision)));
    told.when = now;
}

std::uint16_t HeldExplanations::take_suppressed(Decision decision) {
    return std::exchange(of(decision).suppressed, std::uint16_t{0});
}

}  // namespace aeolis::flight
