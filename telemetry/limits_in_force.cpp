// SPDX-License-Identifier: Apache-2.0
#include "telemetry/limits_in_force.hpp"

#include "telemetry/alarms.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::telemetry {

LimitsInForce::LimitsInForce(const dictionary::Dictionary& dictionary)
    : dictionary_(dictionary), latest_(dictionary.channels.size()) {
    for (const dictionary::Channel& channel : dictionary.channels) {
        const auto& contexts = channel.type.alarms.contexts;
        if (contexts.empty()) continue;
        channels_.push_back({channel.id, {LimitStretch{}}});
        for (const auto& each : contexts)
            for (const auto& condition : each.context) decided_by_.push_back(condition.channel);
    }
    std::ranges::sort(decided_by_, {}, &ChannelId::value);
    decided_by_.erase(std::ranges::unique(decided_by_).begin(), decided_by_.end());
}

void LimitsInForce::sample(ChannelId channel, double value, Sclk sclk) {
    if (std::isnan(value)) return;
    auto& latest = latest_[channel.value];
    if (latest == value) return;
    latest = value;
    for (auto& [limited, stretches] : channels_) {
        const auto* context = context_in_force(dictionary_.channels[limited.value].type.alarms, latest_);
        if (context == stretches.back().context) continue;
        if (stretches.back().from == sclk)  // several values of one packet decide together
            stretches.pop_back();
        if (stretches.back().context == context) continue;
        stretches.push_back({sclk, context});
    }
}

}  // namespace aeolis::telemetry
