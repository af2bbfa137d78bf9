// SPDX-License-Identifier: Apache-2.0
#include "telemetry/packet_stream.hpp"

#include "common/space_packet.hpp"

namespace aeolis::telemetry {

std::optional<std::span<const std::uint8_t>> PacketStream::next() {
    const auto header = read_primary_header(rest_);
    if (!header || header->packet_octets() > rest_.size()) return std::nullopt;
    const auto packet = rest_.first(header->packet_octets());
    rest_ = rest_.subspan(packet.size());
    ++packets_;
    return packet;
}

}  // namespace aeolis::telemetry
