// SPDX-License-Identifier: Apache-2.0
#include "telemetry/frame_receiver.hpp"

#include "common/crc.hpp"
#include "common/randomiser.hpp"
#include "telemetry/packet_extractor.hpp"

#include <algorithm>
#include <array>

namespace aeolis::telemetry {
namespace {

constexpr std::size_t shortest_frame_octets = 9;  // a header, a CRC and one octet

bool begins_with_marker(std::span<const std::uint8_t> octets) {
    return octets.size() >= attached_sync_marker.size() &&
           std::equal(attached_sync_marker.begin(), attached_sync_marker.end(), octets.begin());
}

/// The number of whole packets in a stream under this layout, less those that its own frames contradict.
///
/// With check symbols read as data, a packet ends where no frame says that the next begins. None when no frame can be
/// read.
std::optional<std::int64_t> packets_in_agreement(const FrameStream& stream, std::span<const std::uint8_t> octets) {
    FrameReceiver receiver{stream};
    receiver.receive(octets);
    std::map<std::uint32_t, PacketExtractor> channels;
    while (const auto received = receiver.next()) {
        PacketExtractor& channel = channels[received->frame.spacecraft * 64U + received->frame.virtual_channel];
        channel.add(received->frame, received->missing_before > 0);
        while (channel.next()) {
        }
    }
    if (channels.empty()) return std::nullopt;
    std::int64_t agreement = 0;
    for (const auto& [id, channel] : channels) {
        const PacketCounters& counted = channel.counters();
        agreement += static_cast<std::int64_t>(counted.packets + counted.idle_packets);
        agreement -= static_cast<std::int64_t>(counted.cut_packets + (counted.unreadable_octets > 0 ? 1 : 0));
    }
    return agreement;
}

}  // namespace

FrameReceiver::FrameReceiver(const FrameStream& stream) : stream_(stream) {
    AEOLIS_CHECK(stream.frame_octets >= shortest_frame_octets && stream.frame_octets <= transfer_frame_octets_max);
}

void FrameReceiver::receive(std::span<const std::uint8_t> octets) {
    window_.add(octets);
    counters_.octets += octets.size();
}

void FrameReceiver::skip(std::size_t octets) {
    window_.use(octets);
    counters_.skipped_octets += octets;
}

void FrameReceiver::end() {
    while (next()) {
    }
    skip(window_.rest().size());
}

std::size_t FrameReceiver::unit_octets() const {
    return (stream_.marker ? attached_sync_marker.size() : stream_.prefix_octets) + stream_.frame_octets +
           stream_.suffix_octets;
}

/// Skips to the next marker. Returns false when there is none.
bool FrameReceiver::at_marker() {
    while (true) {
        skip(find_octet(window_.rest(), attached_sync_marker.front()));
        if (window_.rest().size() < attached_sync_marker.size()) return false;
        if (begins_with_marker(window_.rest())) return true;
        skip(1);
    }
}

std::optional<FrameReceiver::Received> FrameReceiver::next() {
    while (!stream_.marker || at_marker()) {
        if (window_.rest().size() < unit_octets()) return std::nullopt;
        const std::size_t before = stream_.marker ? attached_sync_marker.size() : stream_.prefix_octets;
        const auto octets = window_.rest().subspan(before, stream_.frame_octets);
        frame_.assign(octets.begin(), octets.end());
        if (stream_.randomised) randomise_tm(frame_);
        const auto frame = stream_.kind == FrameStream::Kind::tm ? read_tm_frame(frame_, stream_.agreed)
                                                                 : read_aos_frame(frame_, stream_.agreed);
        if (!frame) {
            ++(frame.why() == Malformed::bad_checksum ? counters_.bad_crc : counters_.bad_header);
            skip(stream_.marker ? before : unit_octets());
            continue;
        }
        window_.use(unit_octets());
        ++counters_.frames;
        const std::uint32_t channel = frame->spacecraft * 64U + frame->virtual_channel;
        return Received{*frame, channels_[channel].next(frame->count, frame->count_modulus, counters_)};
    }
    return std::nullopt;
}

std::optional<std::size_t> cadu_frame_octets(std::span<const std::uint8_t> octets) {
    constexpr std::size_t markers_seen_max = 1000;
    std::map<std::size_t, std::size_t> distances;
    std::optional<std::size_t> last;
    std::size_t seen = 0;
    for (std::size_t at = 0; at < octets.size() && seen < markers_seen_max; ++at) {
        at += find_octet(octets.subspan(at), attached_sync_marker.front());
        if (at >= octets.size() || !begins_with_marker(octets.subspan(at))) continue;
        const std::size_t least = attached_sync_marker.size() + shortest_frame_octets;
        if (last && at - *last >= least && at - *last <= transfer_frame_octets_max + attached_sync_marker.size())
            ++distances[at - *last];
        last = at;
        ++seen;
    }
    const auto most = std::ranges::max_element(distances, {}, [](const auto& each) { return each.second; });
    if (most == distances.end()) return std::nullopt;
    return most->first - attached_sync_marker.size();
}

std::optional<FrameStream> recognise_cadus(std::span<const std::uint8_t> octets) {
    constexpr std::size_t looked_at_octets = std::size_t{1} << 20U;
    // Reed-Solomon: 32 or 16 check symbols a code word, 1 to 8 code words interleaved. [ccsds-131.0-b-5]
    constexpr std::array<std::size_t, 10> check_symbols{0, 16, 32, 48, 64, 80, 96, 128, 160, 256};
    octets = octets.first(std::min(octets.size(), looked_at_octets));
    const auto length = cadu_frame_octets(octets);
    if (!length) return std::nullopt;
    std::optional<FrameStream> best;
    std::int64_t most = 0;
    for (const bool crc : {true, false}) {
        if (best) break;  // a right CRC leaves no doubt
        for (const std::size_t symbols : check_symbols)
            for (const bool randomised : {false, true})
                for (const auto kind : {FrameStream::Kind::tm, FrameStream::Kind::aos}) {
                    if (*length < symbols + shortest_frame_octets) continue;
                    FrameStream stream;
                    stream.kind = kind;
                    stream.frame_octets = *length - symbols;
                    stream.suffix_octets = symbols;
                    stream.randomised = randomised;
                    stream.agreed.crc = crc;
                    const auto agreement = packets_in_agreement(stream, octets);
                    if (!agreement || (best && *agreement <= most)) continue;
                    best = stream;
                    most = *agreement;
                }
    }
    return best;
}

std::optional<std::size_t> crc_frame_octets(std::span<const std::uint8_t> octets, std::size_t prefix_octets) {
    if (octets.size() <= prefix_octets) return std::nullopt;
    const auto first = octets.subspan(prefix_octets);
    const std::size_t most = std::min(first.size(), transfer_frame_octets_max);
    if (most < shortest_frame_octets) return std::nullopt;
    std::uint16_t crc = crc16(first.first(shortest_frame_octets - 1));
    for (std::size_t size = shortest_frame_octets; size <= most; ++size) {
        crc = crc16(first.subspan(size - 1, 1), crc);
        if (crc != 0) continue;
        const auto second = first.subspan(size);
        if (second.empty()) return size;
        if (second.size() >= prefix_octets + size && crc16(second.subspan(prefix_octets, size)) == 0) return size;
    }
    return std::nullopt;
}

}  // namespace aeolis::telemetry
