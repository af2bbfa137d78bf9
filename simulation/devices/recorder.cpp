// SPDX-License-Identifier: Apache-2.0
#include "simulation/devices/recorder.hpp"

#include "common/space_packet.hpp"

namespace aeolis::simulation {

bool Recorder::append(std::span<const std::uint8_t> packets) {
    if (used_octets() + packets.size() > capacity_octets_) {
        refused_octets_ += packets.size();
        return false;
    }
    octets_.insert(octets_.end(), packets.begin(), packets.end());
    return true;
}

void Recorder::forget() {
    forgotten_octets_ += octets_.size();
    octets_.clear();
}

std::span<const std::uint8_t> take_packet(std::span<const std::uint8_t>& octets) {
    const auto header = read_primary_header(octets);
    if (!header || header->packet_octets() > octets.size()) return {};
    const auto packet = octets.first(header->packet_octets());
    octets = octets.subspan(packet.size());
    return packet;
}

}  // namespace aeolis::simulation
