// SPDX-License-Identifier: Apache-2.0
#include "telemetry/packet_extractor.hpp"

#include "common/bytes.hpp"
#include "common/space_packet.hpp"

namespace aeolis::telemetry {

void PacketExtractor::forget_begun() {
    if (begun_octets_ > 0) ++counters_.cut_packets;
    counters_.unreadable_octets += begun_octets_;
    begun_octets_ = 0;
    octets_.clear();
    in_step_ = false;
}

void PacketExtractor::begin_at(const TransferFrame& frame) {
    const bool begins = frame.first_header_pointer != no_packet_begins;
    const std::size_t before = begins ? frame.first_header_pointer : frame.data.size();
    counters_.unreadable_octets += before;
    octets_.assign(frame.data.begin() + static_cast<std::ptrdiff_t>(before), frame.data.end());
    in_step_ = begins;
}

/// Whether the unfinished packet, continued by this frame, ends where the frame says that the next begins.
bool PacketExtractor::pointer_agrees(const TransferFrame& frame) const {
    std::size_t missing = 0;
    if (begun_octets_ > 0) {
        if (octets_.size() < primary_header_octets) return frame.first_header_pointer == no_packet_begins;
        const auto whole = space_packet_octets(octets_);
        if (!whole) return false;
        missing = *whole - begun_octets_;
    }
    return frame.first_header_pointer == (missing < frame.data.size() ? missing : std::size_t{no_packet_begins});
}

void PacketExtractor::add(const TransferFrame& frame, bool missing_before) {
    while (next()) {
    }
    octets_.erase(octets_.begin(), octets_.begin() + static_cast<std::ptrdiff_t>(used_));
    used_ = 0;
    begun_octets_ = octets_.size();
    if (missing_before) forget_begun();
    if (frame.first_header_pointer == only_idle_data) return;
    if (in_step_) {
        octets_.insert(octets_.end(), frame.data.begin(), frame.data.end());
        if (pointer_agrees(frame)) return;
        octets_.resize(begun_octets_);
        forget_begun();
    }
    begin_at(frame);
}

std::optional<std::span<const std::uint8_t>> PacketExtractor::next() {
    while (true) {
        const auto rest = std::span{octets_}.subspan(used_);
        if (rest.size() < primary_header_octets) return std::nullopt;
        const auto size = space_packet_octets(rest);
        if (!size) {
            counters_.unreadable_octets += rest.size();
            used_ = octets_.size();
            in_step_ = false;
            return std::nullopt;
        }
        if (*size > rest.size()) return std::nullopt;
        used_ += *size;
        if (read_bits(rest, 5, 11) == idle_apid) {
            ++counters_.idle_packets;
            continue;
        }
        ++counters_.packets;
        return rest.first(*size);
    }
}

}  // namespace aeolis::telemetry
