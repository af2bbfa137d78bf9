// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ids.hpp"
#include "common/time.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

// Values of any channels as ground's own flight has them: the binary data of packet "ShadowValues", both ends.
namespace aeolis::telemetry {

/// A channel's value at an instant of a second.
struct ExpectedValue {
    ChannelId channel;
    Sclk at;
    std::optional<double> value;  ///< none: undefined
};

inline constexpr std::size_t expected_values_max = 64;  ///< in one packet; chosen
inline constexpr std::size_t expected_value_octets = 11;
using ExpectedValues = std::array<std::uint8_t, expected_values_max * expected_value_octets>;

/// Packs at most expected_values_max values of the second that begins at `second`. A value's tick within the second
/// goes with it; what is left is filled with a channel that there is not.
ExpectedValues pack_expected_values(std::span<const ExpectedValue> values, Sclk second);

/// Passes each value to `take`, in order. Octets of another length: none.
void unpack_expected_values(std::span<const std::uint8_t> octets, Sclk second,
                            const std::function<void(const ExpectedValue&)>& take);

}  // namespace aeolis::telemetry
