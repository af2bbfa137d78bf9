// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/bytes.hpp"
#include "generated/dictionary_flight.hpp"
#include "telemetry/packet_stream.hpp"

#include <cstdint>
#include <span>

namespace aeolis::tests {

/// The number of an event's reports in a recording.
template <typename Evr>
int count_recorded(std::span<const std::uint8_t> recording) {
    int count = 0;
    telemetry::PacketStream packets{recording};
    while (const auto packet = packets.next()) {
        const auto header = read_tm_packet(*packet);
        if (header && header->primary.apid == Evr::apid &&
            read_bits(*packet, tm_data_offset_octets * 8, 16) == Evr::id.value)
            ++count;
    }
    return count;
}

}  // namespace aeolis::tests
