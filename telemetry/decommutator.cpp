// SPDX-License-Identifier: Apache-2.0
#include "telemetry/decommutator.hpp"

#include "common/check.hpp"

#include <algorithm>

namespace aeolis::telemetry {

const char* name_of(Refusal refusal) {
    switch (refusal) {
    case Refusal::not_a_packet: return "not_a_packet";
    case Refusal::bad_crc: return "bad_crc";
    case Refusal::other_dictionary: return "other_dictionary";
    case Refusal::unknown_apid: return "unknown_apid";
    case Refusal::unknown_event: return "unknown_event";
    case Refusal::wrong_length: return "wrong_length";
    }
    return "";
}

Decommutator::Decommutator(const dictionary::Dictionary& dictionary)
    : dictionary_id_(dictionary.id), model_(dictionary.model) {
    AEOLIS_CHECK(model_ || dictionary.packets.empty());
    if (!model_) return;
    std::vector<std::size_t> fields;
    for (const auto& container : model_->containers) {
        Described& described = described_.emplace_back();
        const auto packet = std::ranges::find(dictionary.packets, container.name, &dictionary::Packet::name);
        const bool is_packet = !container.abstract && packet != dictionary.packets.end();
        fields.push_back(is_packet ? packet->fields.size() : 0);
        if (!is_packet) continue;
        described.packet = static_cast<std::size_t>(packet - dictionary.packets.begin());
        described.octets = packet->octets;
    }
    for (const auto& packet : dictionary.packets)
        if (packet.event && std::ranges::find(event_apids_, packet.apid) == event_apids_.end())
            event_apids_.push_back(packet.apid);
    const auto field_of = [&](std::size_t container, std::size_t,
                              const std::string& name) -> std::optional<std::size_t> {
        const std::size_t packet = described_[container].packet;
        return packet == no_packet ? std::nullopt : field_index(dictionary.packets[packet], name);
    };
    const auto needs_text_at = [&](std::size_t container, std::size_t field) {
        return needs_text(dictionary.packets[described_[container].packet].fields[field].type);
    };
    plan_.emplace(*model_, fields, field_of, needs_text_at);
    for (std::size_t i = 0; i < described_.size(); ++i)
        AEOLIS_CHECK(described_[i].packet == no_packet || plan_->is_compiled(i));
}

std::optional<Refusal> Decommutator::decode(std::span<const std::uint8_t> packet, Decoded& into) const {
    const auto header = read_tm_packet(packet);
    if (!header) {
        const auto primary = read_primary_header(packet);
        const bool whole = primary && !primary->telecommand && primary->secondary_header &&
                           packet.size() >= tm_overhead_octets && packet.size() == primary->packet_octets();
        return whole ? Refusal::bad_crc : Refusal::not_a_packet;
    }
    if (header->dictionary_id != dictionary_id_) return Refusal::other_dictionary;
    if (!plan_) return Refusal::unknown_apid;

    const auto contents = packet.first(packet.size() - packet_crc_octets);
    const auto reached = plan_->reach(contents);
    if (reached && reached->cut) return Refusal::wrong_length;
    const Described described = reached ? described_[reached->container] : Described{};
    if (described.packet == no_packet) {
        const bool is_event = std::ranges::find(event_apids_, header->primary.apid) != event_apids_.end();
        return is_event ? Refusal::unknown_event : Refusal::unknown_apid;
    }
    if (packet.size() != described.octets) return Refusal::wrong_length;
    plan_->read(reached->container, contents, into);
    into.packet = described.packet;
    into.header = *header;
    return std::nullopt;
}

}  // namespace aeolis::telemetry
