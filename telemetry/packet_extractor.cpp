// SPDX-License-Identifier: Apache-2.0
#include "telemetry/packet_extractor.hpp"

#include "common/bytes.hpp"
#include "common/space_packet.hpp"

#include <algorithm>

namespace aeolis::telemetry {
namespace {

std::span<const std::uint8_t> data_from_pointer(const TransferFrame& frame) {
    return frame.first_header_pointer == no_packet_begins ? std::span<const std::uint8_t>{}
                                                          : frame.data.subspan(frame.first_header_pointer);
}

}  // namespace

PacketCounters& PacketCounters::operator+=(const PacketCounters& other) {
    packets += other.packets;
    idle_packets += other.idle_packets;
    encapsulation_packets += other.encapsulation_packets;
    cut_packets += other.cut_packets;
    lost_segments += other.lost_segments;
    unreadable_octets += other.unreadable_octets;
    return *this;
}

bool PacketCounters::count(PacketStart::Kind kind) {
    switch (kind) {
    case PacketStart::Kind::space: ++packets; return true;
    case PacketStart::Kind::idle: ++idle_packets; return false;
    case PacketStart::Kind::encapsulation: ++encapsulation_packets; return false;
    case PacketStart::Kind::unknown: break;
    }
    return false;
}

void PacketExtractor::forget_begun() {
    if (begun_octets_ > 0) ++counters_.cut_packets;
    counters_.unreadable_octets += begun_octets_;
    begun_octets_ = 0;
    octets_.clear();
    in_step_ = false;
}

void PacketExtractor::begin_at(const TransferFrame& frame) {
    const auto data = data_from_pointer(frame);
    counters_.unreadable_octets += frame.data.size() - data.size();
    octets_.assign(data.begin(), data.end());
    in_step_ = !data.empty();
}

/// Whether the unfinished packet, continued by this frame, ends where the frame says that the next begins.
bool PacketExtractor::pointer_agrees(const TransferFrame& frame) const {
    std::size_t missing = 0;
    if (begun_octets_ > 0) {
        const auto begun = packet_start(octets_);
        if (begun.kind == PacketStart::Kind::unknown) return false;
        if (begun.octets == 0) return frame.first_header_pointer == no_packet_begins;
        missing = begun.octets - begun_octets_;
    }
    return frame.first_header_pointer == (missing < frame.data.size() ? missing : std::size_t{no_packet_begins});
}

void PacketExtractor::add(const TransferFrame& frame, FramePlace place) {
    while (next()) {
    }
    if (place == FramePlace::repeated || (place == FramePlace::late && frame.first_header_pointer == only_idle_data))
        return;
    if (place == FramePlace::late) return add_late(frame);
    octets_.erase(octets_.begin(), octets_.begin() + static_cast<std::ptrdiff_t>(used_));
    used_ = 0;
    begun_octets_ = octets_.size();
    if (place != FramePlace::next) forget_begun();
    if (frame.first_header_pointer == only_idle_data) return;
    if (in_step_) {
        octets_.insert(octets_.end(), frame.data.begin(), frame.data.end());
        if (pointer_agrees(frame)) return;
        octets_.resize(begun_octets_);
        forget_begun();
    }
    begin_at(frame);
}

void PacketExtractor::end() {
    while (next()) {
    }
    const auto rest = std::span{octets_}.subspan(used_);
    if (!rest.empty() && packet_start(rest).kind != PacketStart::Kind::idle) {
        ++counters_.cut_packets;
        counters_.unreadable_octets += rest.size();
    }
    octets_.clear();
    used_ = begun_octets_ = 0;
    in_step_ = false;
}

void PacketExtractor::add_late(const TransferFrame& frame) {
    const auto data = data_from_pointer(frame);
    counters_.unreadable_octets += frame.data.size() - data.size();
    late_.assign(data.begin(), data.end());
    late_used_ = 0;
}

std::optional<std::span<const std::uint8_t>> PacketExtractor::next() {
    if (const auto packet = next_in(late_, late_used_)) return packet;
    if (late_used_ < late_.size()) {  // its last packet goes on in a frame that is not there, or was used already
        ++counters_.cut_packets;
        counters_.unreadable_octets += late_.size() - late_used_;
    }
    late_.clear();
    late_used_ = 0;
    return next_in(octets_, used_);
}

std::optional<std::span<const std::uint8_t>> PacketExtractor::next_in(const std::vector<std::uint8_t>& octets,
                                                                      std::size_t& used) {
    while (used < octets.size()) {
        const auto rest = std::span{octets}.subspan(used);
        const auto start = packet_start(rest);
        if (start.kind == PacketStart::Kind::unknown) {
            counters_.unreadable_octets += rest.size();
            used = octets.size();
            if (&octets == &octets_) in_step_ = false;
            return std::nullopt;
        }
        if (start.octets == 0 || start.octets > rest.size()) return std::nullopt;
        used += start.octets;
        if (counters_.count(start.kind)) return rest.first(start.octets);
    }
    return std::nullopt;
}

}  // namespace aeolis::telemetry
