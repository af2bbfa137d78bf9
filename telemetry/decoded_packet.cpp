// SPDX-License-Identifier: Apache-2.0
#include "telemetry/decoded_packet.hpp"

#include "telemetry/other_mission.hpp"
#include "telemetry/text.hpp"

namespace aeolis::telemetry {

PacketDecoder::PacketDecoder(const dictionary::Dictionary& dictionary, const OtherMission* other)
    : dictionary_(&dictionary), other_(other) {
    if (other_ == nullptr) decommutator_.emplace(dictionary);
}

void PacketDecoder::decode(std::span<const std::uint8_t> packet, DecodedPacket& into) const {
    into.event = nullptr;
    into.text.clear();
    into.refusal.clear();
    if (other_ != nullptr) {
        if (auto refusal = other_->decode(packet, into.content)) into.refusal = std::move(*refusal);
        return;
    }
    if (const auto refusal = decommutator_->decode(packet, into.content)) {
        into.refusal = name_of(*refusal);
        return;
    }
    into.event = event_of(*dictionary_, into.content);
    if (into.event != nullptr) into.text = event_text(*dictionary_, *into.event, into.content);
}

}  // namespace aeolis::telemetry
