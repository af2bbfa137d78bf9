// SPDX-License-Identifier: Apache-2.0
#include "telemetry/segment_assembler.hpp"

#include "common/bytes.hpp"
#include "common/check.hpp"
#include "common/space_packet.hpp"

#include <utility>

namespace aeolis::telemetry {
namespace {

enum class Part : std::uint8_t { middle, first, last, whole };

constexpr std::size_t flags_octet = 2, length_octet = 4;
constexpr std::uint8_t whole_flags = 0xC0;

}  // namespace

std::optional<std::span<const std::uint8_t>> SegmentAssembler::add(std::span<const std::uint8_t> packet,
                                                                   std::uint32_t channel) {
    AEOLIS_CHECK(packet.size() > primary_header_octets);
    const auto part = static_cast<Part>(read_bits(packet, flags_octet * 8, 2));
    if (part == Part::whole) return packet;
    const bool secondary_header = read_bits(packet, 4, 1) != 0;
    const Key key{channel, static_cast<std::uint16_t>(read_bits(packet, 3, 1) << 11U | read_bits(packet, 5, 11))};
    const auto count = static_cast<std::uint16_t>(read_bits(packet, flags_octet * 8 + 2, 14));
    if (part == Part::first) {
        give_up(key);
        if (begun_.size() == unfinished_max) give_up(Key{begun_.begin()->first});
        begun_[key] = {{packet.begin(), packet.end()}, 1, count};
        return std::nullopt;
    }
    const auto found = begun_.find(key);
    const auto data = packet.subspan(primary_header_octets);
    const bool continues = found != begun_.end() && count == ((found->second.count + 1) & packet_count_mask) &&
                           !secondary_header && found->second.octets.size() + data.size() <= space_packet_octets_max;
    if (!continues) {
        give_up(key);
        ++lost_;
        return std::nullopt;
    }
    auto& begun = found->second;
    begun.octets.insert(begun.octets.end(), data.begin(), data.end());
    begun.count = count;
    ++begun.segments;
    if (part == Part::middle) return std::nullopt;
    whole_ = std::move(begun.octets);
    begun_.erase(found);
    whole_[flags_octet] |= whole_flags;
    const auto length = whole_.size() - primary_header_octets - 1;
    whole_[length_octet] = static_cast<std::uint8_t>(length >> 8);
    whole_[length_octet + 1] = static_cast<std::uint8_t>(length & 0xFF);
    return whole_;
}

void SegmentAssembler::give_up(const Key& key) {
    const auto found = begun_.find(key);
    if (found == begun_.end()) return;
    lost_ += found->second.segments;
    begun_.erase(found);
}

void SegmentAssembler::end() {
    while (!begun_.empty()) give_up(Key{begun_.begin()->first});
}

}  // namespace aeolis::telemetry
