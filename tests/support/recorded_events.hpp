// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/bytes.hpp"
#include "generated/dictionary_flight.hpp"
#include "telemetry/packet_stream.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace aeolis::tests {

/// A report of an event: its time, and the first octet of its data behind the event's number.
struct RecordedEvent {
    Sclk at;
    std::uint8_t octet = 0;
};
template <typename Evr>
std::vector<RecordedEvent> recorded(std::span<const std::uint8_t> recording) {
    std::vector<RecordedEvent> all;
    telemetry::PacketStream packets{recording};
    while (const auto packet = packets.next()) {
        const auto header = read_tm_packet(*packet);
        if (!header || header->primary.apid != Evr::apid ||
            read_bits(*packet, tm_data_offset_octets * 8, 16) != Evr::id.value)
            continue;
        all.push_back(
            {header->time, static_cast<std::uint8_t>(read_bits(*packet, (tm_data_offset_octets + 2) * 8, 8))});
    }
    return all;
}

/// The number of an event's reports in a recording.
template <typename Evr>
int count_recorded(std::span<const std::uint8_t> recording) {
    return static_cast<int>(recorded<Evr>(recording).size());
}

}  // namespace aeolis::tests
