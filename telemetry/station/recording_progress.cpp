// SPDX-License-Identifier: Apache-2.0
#include "telemetry/station/recording_progress.hpp"

#include "telemetry/station/recording_receiver.hpp"

#include <algorithm>

namespace aeolis::telemetry {

RecordingProgress::RecordingProgress(const dictionary::Dictionary& dictionary) {
    for (std::size_t i = 0; i < dictionary.packets.size(); ++i)
        for (const char* name : {"nvm_used_octets", "nvm_used_octets_b"})
            if (const auto field = dictionary::field_index(dictionary.packets[i], name)) sizes_.emplace_back(i, *field);
    const auto touchdown = std::ranges::find(dictionary.events, "TOUCHDOWN", &dictionary::Event::name);
    if (touchdown != dictionary.events.end()) touchdown_ = touchdown->packet;
    const auto event = std::ranges::find(dictionary.events, "RECORDING_CLOSED", &dictionary::Event::name);
    if (event == dictionary.events.end()) return;
    const dictionary::Packet& packet = dictionary.packets[event->packet];
    if (const auto field = dictionary::field_index(packet, "used_octets")) {
        closed_ = {event->packet, *field};
        closed_apid_ = packet.apid;
    }
}

bool RecordingProgress::may_close(std::span<const std::uint8_t> packet) const {
    const auto header = read_primary_header(packet);
    return header && closed_apid_ == header->apid;
}

void RecordingProgress::note(const dictionary::Decoded& packet, bool live) {
    if (closed_ && packet.packet == closed_->first) closed_octets_ = packet.raw[closed_->second];
    if (!live) return;
    landed_ = landed_ || touchdown_ == packet.packet;
    if (!landed_) return;
    for (const auto& [index, field] : sizes_)
        if (packet.packet == index) told_octets_ = std::max<std::uint64_t>(told_octets_, packet.raw[field]);
}

double RecordingProgress::fraction(const RecordingReceiver& received) const {
    constexpr double nearly = 0.999;  // until its last packet is down, more may come
    const std::uint64_t down = received.received_octets();
    const std::uint64_t size = closed_octets_.value_or(told_octets_);
    if (size == 0) return 0.0;
    if (closed_octets_ && down > size && received.files_under_way() == 0) return 1.0;
    return std::min(static_cast<double>(down) / static_cast<double>(size), nearly);
}

}  // namespace aeolis::telemetry
