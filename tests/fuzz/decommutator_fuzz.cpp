// SPDX-License-Identifier: Apache-2.0
// Octets from a link, decommutated by the shipped dictionary and put into words. The first octet chooses a packet whose
// headers and CRC are written around the rest, so that the fields are reached; or the octets are taken as they are.
#include "telemetry/explanation.hpp"
#include "telemetry/packet_identity.hpp"
#include "telemetry/text.hpp"

#include <algorithm>
#include <cstdlib>

namespace {

using namespace aeolis;

const dictionary::Dictionary& mission() {
    static const auto loaded = dictionary::load(AEOLIS_SOURCE_DIR "/dictionaries/msl");
    if (!loaded.dictionary) std::abort();
    return *loaded.dictionary;
}

std::vector<std::uint8_t> sealed(const dictionary::Packet& wanted, std::span<const std::uint8_t> data) {
    std::vector<std::uint8_t> octets(wanted.octets);
    const std::size_t room = octets.size() - tm_overhead_octets;
    std::copy_n(data.begin(), std::min(room, data.size()), octets.begin() + tm_data_offset_octets);
    if (wanted.event) {
        octets[tm_data_offset_octets] = static_cast<std::uint8_t>(wanted.event->value >> 8);
        octets[tm_data_offset_octets + 1] = static_cast<std::uint8_t>(wanted.event->value & 0xFF);
    }
    seal_tm_packet(octets, wanted.apid, 0, {}, mission().id);
    return octets;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const telemetry::Decommutator decommutator{mission()};
    static telemetry::Decoded decoded;
    if (size == 0) return 0;
    const std::span rest{data + 1, size - 1};
    const std::size_t choice = data[0];
    const bool ours = choice < mission().packets.size();
    const auto octets =
        ours ? sealed(mission().packets[choice], rest) : std::vector<std::uint8_t>{rest.begin(), rest.end()};

    const auto refusal = decommutator.decode(octets, decoded);
    if (ours && refusal) std::abort();  // every content of a packet of ours is decoded
    if (refusal) return 0;

    const auto& packet = mission().packets[decoded.packet];
    if (decoded.value.size() != packet.fields.size()) std::abort();
    for (std::size_t i = 0; i < packet.fields.size(); ++i)
        (void)telemetry::value_text(packet.fields[i].type, decoded.value[i]);
    if (const auto* event = telemetry::event_of(mission(), decoded))
        (void)telemetry::event_text(mission(), *event, decoded);
    (void)telemetry::explain(mission(), decoded);
    (void)telemetry::identity_of(octets);
    return 0;
}
