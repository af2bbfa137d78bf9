// SPDX-License-Identifier: Apache-2.0
#include "server/api/limits_in_force.hpp"

#include "server/api/dictionary_reply.hpp"
#include "telemetry/alarms.hpp"
#include "telemetry/limits_in_force.hpp"

#include <fmt/format.h>

namespace aeolis::server {

Result<v1::LimitsInForce> limits_in_force(archive::Reader& reader, archive::RunId run,
                                          const dictionary::Dictionary& dictionary, bool recorded) {
    telemetry::LimitsInForce limits{dictionary};
    v1::LimitsInForce answer;
    std::vector<std::string> names;
    for (const ChannelId channel : limits.decided_by()) {
        answer.add_decided_by(channel.value);
        names.push_back(dictionary.channels[channel.value].name);
    }
    const auto take = [&](std::span<const archive::ChannelValue> samples) -> Result<void> {
        for (const auto& sample : samples)
            if (recorded || sample.source == archive::Source::realtime)
                limits.sample(sample.channel, sample.value, sample.sclk);
        std::size_t stretches = 0;
        for (const auto& channel : limits.channels()) stretches += channel.stretches.size();
        if (stretches > limit_stretches_max)
            return Error{fmt::format("the limits of this run changed more than {} times", limit_stretches_max)};
        return {};
    };
    if (!names.empty())  // none would be all
        if (auto done = reader.each_sample(run, names, {}, take); !done) return done.error();
    for (const auto& [id, stretches] : limits.channels()) {
        const auto& channel = dictionary.channels[id.value];
        auto& added = *answer.add_channels();
        added.set_id(id.value);
        added.set_name(channel.name);
        for (const auto& [from, context] : stretches) {
            if (from) added.mutable_stretches()->rbegin()->set_to_sclk(from->seconds);
            auto& stretch = *added.add_stretches();
            if (from) stretch.set_from_sclk(from->seconds);
            if (context) stretch.set_context(telemetry::context_text(dictionary, context->context));
            add_limits(context ? context->alarms : channel.type.alarms, stretch.context(), *stretch.mutable_limits());
        }
    }
    return answer;
}

}  // namespace aeolis::server
