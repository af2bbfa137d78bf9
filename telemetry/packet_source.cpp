// SPDX-License-Identifier: Apache-2.0
#include "telemetry/packet_source.hpp"

#include "common/space_packet.hpp"

#include <array>
#include <utility>

namespace aeolis::telemetry {

std::optional<DownlinkFormat> downlink_format(std::string_view name) {
    constexpr std::array<std::pair<std::string_view, DownlinkFormat>, 5> formats{{{"packets", DownlinkFormat::packets},
                                                                                  {"tm", DownlinkFormat::tm},
                                                                                  {"aos", DownlinkFormat::aos},
                                                                                  {"cadu", DownlinkFormat::cadu},
                                                                                  {"pltu", DownlinkFormat::pltu}}};
    for (const auto& [word, format] : formats)
        if (word == name) return format;
    return std::nullopt;
}

std::optional<std::span<const std::uint8_t>> BarePackets::next() {
    while (!lost_) {
        const auto rest = window_.rest();
        if (rest.size() <= prefix_octets_) return std::nullopt;
        const auto start = packet_start(rest.subspan(prefix_octets_));
        if (start.kind == PacketStart::Kind::unknown) break;
        if (start.octets == 0 || rest.size() < prefix_octets_ + start.octets) return std::nullopt;
        window_.use(prefix_octets_ + start.octets);
        if (counters_.count(start.kind)) return rest.subspan(prefix_octets_, start.octets);
    }
    lost_ = true;
    return std::nullopt;
}

void BarePackets::end() {
    const std::size_t left = window_.rest().size();
    counters_.unreadable_octets += left;
    if (left > 0 && !lost_) ++counters_.cut_packets;
    window_.use(left);
    lost_ = true;
}

void BarePackets::end_datagram() {
    end();
    lost_ = false;
}

void PacketSource::take_from(BarePackets& packets) {
    while (const auto packet = packets.next()) keep(*packet);
}

void PacketSource::take_from(Frames& frames) {
    while (const auto received = frames.receiver.next()) {
        PacketExtractor& channel = frames.channels[received->frame.spacecraft * 64U + received->frame.virtual_channel];
        channel.add(received->frame, received->place);
        while (const auto packet = channel.next()) keep(*packet);
    }
}

void PacketSource::take_from(Pltus& pltus) {
    while (const auto received = pltus.receiver.next()) {
        pltus.packets.add(*received);
        while (const auto packet = pltus.packets.next()) keep(*packet);
    }
}

void PacketSource::receive(std::span<const std::uint8_t> octets) {
    if (auto* packets = std::get_if<BarePackets>(&source_)) {
        packets->receive(octets);
        take_from(*packets);
    } else if (auto* frames = std::get_if<Frames>(&source_)) {
        frames->receiver.receive(octets);
        take_from(*frames);
    } else if (auto* pltus = std::get_if<Pltus>(&source_)) {
        pltus->receiver.receive(octets);
        take_from(*pltus);
    }
}

void PacketSource::end() {
    if (auto* packets = std::get_if<BarePackets>(&source_)) packets->end();
    if (auto* frames = std::get_if<Frames>(&source_)) frames->receiver.end();
    if (auto* pltus = std::get_if<Pltus>(&source_)) {
        pltus->receiver.end();
        take_from(*pltus);
    }
    if (auto* frames = std::get_if<Frames>(&source_))
        for (auto& [id, channel] : frames->channels) channel.end();
    segments_.end();
}

void PacketSource::end_datagram() {
    if (auto* packets = std::get_if<BarePackets>(&source_)) packets->end_datagram();
}

void PacketSource::keep(std::span<const std::uint8_t> packet) {
    if (const auto whole = segments_.add(packet)) whole_.emplace_back(whole->begin(), whole->end());
}

std::optional<std::span<const std::uint8_t>> PacketSource::next() {
    if (whole_.empty()) return std::nullopt;
    given_ = std::move(whole_.front());
    whole_.pop_front();
    return given_;
}

bool PacketSource::lost() const {
    const auto* packets = std::get_if<BarePackets>(&source_);
    return packets != nullptr && packets->lost();
}

LinkCounters PacketSource::link() const {
    if (const auto* frames = std::get_if<Frames>(&source_)) return frames->receiver.counters();
    if (const auto* pltus = std::get_if<Pltus>(&source_)) return pltus->receiver.counters();
    return {};
}

PacketCounters PacketSource::packets() const {
    PacketCounters sum;
    if (const auto* packets = std::get_if<BarePackets>(&source_)) sum = packets->counters();
    if (const auto* pltus = std::get_if<Pltus>(&source_)) sum = pltus->packets.counters();
    if (const auto* frames = std::get_if<Frames>(&source_))
        for (const auto& [id, channel] : frames->channels) sum += channel.counters();
    sum.lost_segments += segments_.lost_segments();
    return sum;
}

}  // namespace aeolis::telemetry
