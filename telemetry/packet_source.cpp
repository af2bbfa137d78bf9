// SPDX-License-Identifier: Apache-2.0
#include "telemetry/packet_source.hpp"

#include "common/bytes.hpp"
#include "common/space_packet.hpp"

#include <array>
#include <string>
#include <utility>

namespace aeolis::telemetry {
namespace {

// Of the first two octets of a packet.
constexpr unsigned secondary_header_flag = 0x0800, command_flag = 0x1000, apid_mask = 0x07FF;
constexpr std::size_t count_bit = 18, count_bits = 14;

}  // namespace

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

bool BarePackets::end_datagram() {
    const bool whole = window_.rest().empty();
    end();
    lost_ = false;
    return whole;
}

void PacketSource::take_from(BarePackets& packets) {
    while (const auto packet = packets.next()) keep(*packet, now_);
}

void PacketSource::keep_all(PacketExtractor& extractor, ChannelNumber channel) {
    while (const auto packet = extractor.next()) keep(*packet, extractor.received(), channel);
}

void PacketSource::take_from(Frames& frames) {
    while (const auto received = frames.receiver.next()) {
        const ChannelNumber number = channel_number(received->frame);
        PacketExtractor& channel =
            frames.channels.at(number, [&](ChannelNumber heard_before, PacketExtractor& forgotten) {
                forgotten.end();
                keep_all(forgotten, heard_before);
                frames.forgotten += forgotten.counters();
                frames.pointers_forgotten += forgotten.pointers();
            });
        channel.add(received->frame, received->place, now_);
        keep_all(channel, number);
    }
}

void PacketSource::take_from(Pltus& pltus) {
    while (const auto received = pltus.receiver.next()) {
        pltus.packets.add(*received);
        while (const auto packet = pltus.packets.next()) keep(*packet, now_);
    }
}

void PacketSource::receive(std::span<const std::uint8_t> octets, Ert at) {
    now_ = at;
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

void PacketSource::end(Ert at) {
    now_ = at;
    if (auto* packets = std::get_if<BarePackets>(&source_)) packets->end();
    if (auto* frames = std::get_if<Frames>(&source_)) frames->receiver.end();
    if (auto* pltus = std::get_if<Pltus>(&source_)) {
        pltus->receiver.end();
        take_from(*pltus);
    }
    if (auto* frames = std::get_if<Frames>(&source_))
        frames->channels.each([this](ChannelNumber number, PacketExtractor& channel) {
            channel.end();
            keep_all(channel, number);
        });
    segments_.end();
}

bool PacketSource::end_datagram() {
    if (auto* packets = std::get_if<BarePackets>(&source_)) return packets->end_datagram();
    if (auto* frames = std::get_if<Frames>(&source_)) return frames->receiver.end_datagram();
    return true;
}

void PacketSource::keep(std::span<const std::uint8_t> packet, Ert received, std::optional<ChannelNumber> channel) {
    const auto id = static_cast<std::uint16_t>(read_bits(packet, 0, 16) & ~secondary_header_flag);
    auto& order = packet_orders_.at({channel, id}, [](const PacketKey&, const FrameOrder&) {});
    order.place(static_cast<std::uint32_t>(read_bits(packet, count_bit, count_bits)), 1U << count_bits, packet,
                packet_ids_.of({channel, id}));
    if (const auto whole = segments_.add(packet, channel ? *channel + 1 : 0))
        whole_.push_back({{whole->begin(), whole->end()}, received});
}

std::optional<std::span<const std::uint8_t>> PacketSource::next() {
    if (whole_.empty()) return std::nullopt;
    given_ = std::move(whole_.front());
    whole_.pop_front();
    return given_.octets;
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

std::uint64_t PacketSource::stray_octets() const {
    if (const auto* frames = std::get_if<Frames>(&source_)) return frames->receiver.stray_octets();
    if (const auto* pltus = std::get_if<Pltus>(&source_)) return pltus->receiver.stray_octets();
    return 0;
}

PacketCounters PacketSource::packets() const {
    PacketCounters sum;
    if (const auto* packets = std::get_if<BarePackets>(&source_)) sum = packets->counters();
    if (const auto* pltus = std::get_if<Pltus>(&source_)) sum = pltus->packets.counters();
    if (const auto* frames = std::get_if<Frames>(&source_)) {
        sum = frames->forgotten;
        frames->channels.each([&](ChannelNumber, const PacketExtractor& channel) { sum += channel.counters(); });
    }
    sum.lost_segments += segments_.lost_segments();
    return sum;
}

PointerVerdicts PacketSource::pointers() const {
    const auto* frames = std::get_if<Frames>(&source_);
    if (frames == nullptr) return {};
    auto sum = frames->pointers_forgotten;
    frames->channels.each([&](ChannelNumber, const PacketExtractor& channel) { sum += channel.pointers(); });
    return sum;
}

std::vector<SequenceTotals> PacketSource::sequences() const {
    std::vector<SequenceTotals> totals;
    if (const auto* frames = std::get_if<Frames>(&source_)) totals = frames->receiver.sequences();
    if (const auto* pltus = std::get_if<Pltus>(&source_)) totals = pltus->receiver.sequences();
    for (const auto& [key, counters] : packet_ids_.rows()) {
        const auto& [channel, id] = key;
        std::string name;
        if (channel)
            name = "spacecraft " + std::to_string(*channel / virtual_channels_max) + ", virtual channel " +
                   std::to_string(*channel % virtual_channels_max) + ", ";
        name += "APID " + std::to_string(id & apid_mask);
        if ((id & command_flag) != 0) name += " (telecommand)";
        totals.push_back({name, true, counters});
    }
    if (packet_ids_.others().received > 0) totals.push_back({other_sequences, true, packet_ids_.others()});
    return totals;
}

}  // namespace aeolis::telemetry
