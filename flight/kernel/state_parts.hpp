// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/message.hpp"

#include <algorithm>
#include <span>

namespace aeolis::flight {

/// Sends the octets of a state in parts that fit a message. R33
template <typename Send>
void state_parts(std::span<const std::uint8_t> octets, Sclk time, Send&& send) {
    const std::size_t count = (octets.size() + state_part_octets_max - 1) / state_part_octets_max;
    StatePart part{.time = time, .count = static_cast<std::uint8_t>(count)};  // a part keeps octets of the one before
    for (std::size_t i = 0; i < count; ++i) {
        const auto rest = octets.subspan(i * state_part_octets_max);
        part.index = static_cast<std::uint8_t>(i);
        part.size = static_cast<std::uint8_t>(std::min(rest.size(), state_part_octets_max));
        std::copy_n(rest.begin(), part.size, part.octets.begin());
        send(part);
    }
}

}  // namespace aeolis::flight
