// SPDX-License-Identifier: Apache-2.0
#include "telemetry/station/expected_values.hpp"

#include "common/bytes.hpp"
#include "common/check.hpp"

#include <bit>
#include <cmath>
#include <limits>

namespace aeolis::telemetry {
namespace {

constexpr std::uint16_t no_channel = 0xFFFF;

}  // namespace

ExpectedValues pack_expected_values(std::span<const ExpectedValue> values, Sclk second) {
    AEOLIS_CHECK(values.size() <= expected_values_max);
    ExpectedValues octets{};
    BitWriter out{octets};
    for (std::size_t i = 0; i < expected_values_max; ++i) {
        const bool any = i < values.size();
        out.put(any ? values[i].channel.value : no_channel, 16);
        out.put(any ? static_cast<std::uint64_t>(values[i].at.ticks() - second.ticks()) : 0, 8);
        out.put_double(any ? values[i].value.value_or(std::numeric_limits<double>::quiet_NaN()) : 0.0);
    }
    return octets;
}

void unpack_expected_values(std::span<const std::uint8_t> octets, Sclk second,
                            const std::function<void(const ExpectedValue&)>& take) {
    if (octets.size() != ExpectedValues{}.size()) return;
    BitReader in{octets};
    for (std::size_t i = 0; i < expected_values_max; ++i) {
        const auto channel = static_cast<std::uint16_t>(in.get(16));
        const auto tick = static_cast<double>(in.get(8));
        const auto value = std::bit_cast<double>(in.get(64));
        if (channel == no_channel) return;
        take({ChannelId{channel}, second + tick * seconds_per_tick,
              std::isnan(value) ? std::nullopt : std::optional{value}});
    }
}

}  // namespace aeolis::telemetry
