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
}

void RecordingProgress::note(const dictionary::Decoded& packet) {
    landed_ = landed_ || touchdown_ == packet.packet;
    if (!landed_) return;
    for (const auto& [index, field] : sizes_)
        if (packet.packet == index) told_octets_ = std::max<std::uint64_t>(told_octets_, packet.raw[field]);
}

double RecordingProgress::fraction(const RecordingReceiver& received) const {
    constexpr double nearly = 0.999;  // until its last file is down, more may come
    if (received.whole()) return 1.0;
    if (told_octets_ == 0) return 0.0;
    return std::min(static_cast<double>(received.received_octets()) / static_cast<double>(told_octets_), nearly);
}

}  // namespace aeolis::telemetry
