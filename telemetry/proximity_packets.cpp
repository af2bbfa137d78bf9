// SPDX-License-Identifier: Apache-2.0
#include "telemetry/proximity_packets.hpp"

#include "common/space_packet.hpp"

namespace aeolis::telemetry {

void ProximityPackets::add(const PltuReceiver::Received& received) {
    const ProximityHeader& header = received.frame.header;
    const StreamId stream = header.spacecraft * 4U + header.physical_channel * 2U + header.expedited;
    const bool late = received.place == FramePlace::late;
    if (received.place != FramePlace::next && !late) forget(stream);
    if (!header.supervisory && header.construction == Construction::packets)
        split(received.frame.data);
    else if (!header.supervisory && header.construction == Construction::segments && late)
        counters_.unreadable_octets += received.frame.data.size();  // the packet that it belongs to was given up
    else if (!header.supervisory && header.construction == Construction::segments)
        add_segment(stream, received.frame.data);
    else
        ++other_frames_;
}

void ProximityPackets::split(std::span<const std::uint8_t> packets) {
    while (!packets.empty()) {
        const auto start = packet_start(packets);
        if (start.kind == PacketStart::Kind::unknown || start.octets == 0 || start.octets > packets.size()) {
            counters_.unreadable_octets += packets.size();
            return;
        }
        give_out(start, packets.first(start.octets));
        packets = packets.subspan(start.octets);
    }
}

void ProximityPackets::add_segment(StreamId stream, std::span<const std::uint8_t> segment) {
    if (segment.empty()) return;
    const SegmentHeader header = read_segment_header(segment[0]);
    auto& packets = begun_[stream];
    const auto data = segment.subspan(1);
    auto found = packets.find(header.pseudo_packet);
    if (found != packets.end() && (header.first || found->second.size() + data.size() > space_packet_octets_max)) {
        ++counters_.cut_packets;
        counters_.unreadable_octets += found->second.size();
        packets.erase(found);
        found = packets.end();
    }
    if (found == packets.end()) {
        if (!header.first) {
            counters_.unreadable_octets += data.size();
            return;
        }
        found = packets.emplace(header.pseudo_packet, std::vector<std::uint8_t>{}).first;
    }
    found->second.insert(found->second.end(), data.begin(), data.end());
    if (!header.last) return;
    const std::vector<std::uint8_t> packet = std::move(found->second);
    packets.erase(found);
    split(packet);
}

void ProximityPackets::give_out(const PacketStart& start, std::span<const std::uint8_t> packet) {
    if (start.kind == PacketStart::Kind::space)
        whole_.emplace_back(packet.begin(), packet.end());
    else
        counters_.count(start.kind);
}

void ProximityPackets::forget(StreamId stream) {
    for (const auto& [id, packet] : begun_[stream]) {
        ++counters_.cut_packets;
        counters_.unreadable_octets += packet.size();
    }
    begun_.erase(stream);
}

std::optional<std::span<const std::uint8_t>> ProximityPackets::next() {
    if (whole_.empty()) return std::nullopt;
    given_ = std::move(whole_.front());
    whole_.pop_front();
    ++counters_.packets;
    return given_;
}

}  // namespace aeolis::telemetry
