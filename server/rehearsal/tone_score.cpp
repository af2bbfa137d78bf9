// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/tone_score.hpp"

#include <algorithm>
#include <cstdlib>

namespace aeolis::server {
namespace {

constexpr std::int64_t same_symbol_us = 5'000'000;  // chosen: largest distance of a decision from its symbol

}  // namespace

void ToneScore::sent(const simulation::SentSymbol& symbol) {
    ++sent_;
    undecided_.push_back(symbol);
}

void ToneScore::heard(const telemetry::ReceivedTone& tone) {
    const auto apart_us = [&](const simulation::SentSymbol& symbol) {
        return std::abs(symbol.start.microseconds - tone.start.microseconds);
    };
    const auto nearest = std::ranges::min_element(undecided_, {}, apart_us);
    const bool known = nearest != undecided_.end() && apart_us(*nearest) < same_symbol_us;
    if (tone.tone) {
        const bool right = known && nearest->tone == *tone.tone;
        ++(right ? decoded_ : wrong_);
        if (known && !right) ++mistaken_;
    }
    if (known) undecided_.erase(nearest);
}

ToneScore::Figures ToneScore::figures() const {
    return {sent_, decoded_, wrong_, sent_ - decoded_ - mistaken_};
}

}  // namespace aeolis::server
