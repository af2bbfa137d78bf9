// SPDX-License-Identifier: Apache-2.0
#include "telemetry/packet_extractor.hpp"

#include "common/bytes.hpp"
#include "common/space_packet.hpp"

#include <algorithm>
#include <cstdlib>

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

PointerVerdicts& PointerVerdicts::operator+=(const PointerVerdicts& other) {
    agreed += other.agreed;
    contradicted += other.contradicted;
    for (std::size_t i = 0; i < shifts.size(); ++i) shifts.at(i) += other.shifts.at(i);
    return *this;
}

std::size_t PacketExtractor::held_packets() const {
    std::size_t packets = 0;
    for (std::size_t at = settled_; at < whole_; ++packets) at += packet_start(std::span{octets_}.subspan(at)).octets;
    return packets;
}

void PacketExtractor::forget_begun() {
    if (begun_octets() > 0) ++counters_.cut_packets;
    counters_.unreadable_octets += begun_octets();
    octets_.resize(whole_);
    in_step_ = false;
}

/// Counts packets as cut whose end a pointer contradicts.
void PacketExtractor::drop_held() {
    counters_.cut_packets += held_packets();
    counters_.unreadable_octets += held_octets();
    octets_.erase(octets_.begin() + static_cast<std::ptrdiff_t>(settled_),
                  octets_.begin() + static_cast<std::ptrdiff_t>(whole_));
    whole_ = settled_;
    for (Completed& each : completed_) each.end = std::min(each.end, whole_);
}

/// Decides on what is held without a pointer to judge it by.
void PacketExtractor::settle_held(bool give) {
    if (held_octets() == 0) return;
    if (!give) return drop_held();
    const auto first = octets_.begin() + static_cast<std::ptrdiff_t>(settled_);
    early_.assign(first, octets_.begin() + static_cast<std::ptrdiff_t>(whole_));
    early_used_ = 0;
    early_received_ = completed_.back().received;
    octets_.erase(first, octets_.begin() + static_cast<std::ptrdiff_t>(whole_));
    whole_ = settled_;
    for (Completed& each : completed_) each.end = std::min(each.end, whole_);
}

/// Removes the first octets, of packets that were given out.
void PacketExtractor::use(std::size_t octets) {
    octets_.erase(octets_.begin(), octets_.begin() + static_cast<std::ptrdiff_t>(octets));
    whole_ -= octets;
    settled_ -= octets;
    used_ -= octets;
    for (Completed& each : completed_) each.end -= std::min(each.end, octets);
    std::erase_if(completed_, [](const Completed& each) { return each.end == 0; });
}

void PacketExtractor::begin_at(const TransferFrame& frame) {
    const auto data = data_from_pointer(frame);
    counters_.unreadable_octets += frame.data.size() - data.size();
    octets_.assign(data.begin(), data.end());
    used_ = settled_ = whole_ = 0;
    completed_.clear();
    in_step_ = !data.empty();
    find_whole();
}

/// Finds the packets that are whole now, and those of them that are to be held.
void PacketExtractor::find_whole() {
    completed_.push_back({octets_.size(), received_});
    const bool certain = agreed_in_a_row_ >= agreed_enough;
    while (whole_ < octets_.size()) {
        const auto rest = std::span{octets_}.subspan(whole_);
        const auto start = packet_start(rest);
        if (start.kind == PacketStart::Kind::unknown) {
            const bool at_the_end = rest.size() < doubtful_octets;
            counters_.unreadable_octets += rest.size();
            octets_.resize(whole_);
            in_step_ = false;
            // No packet begins behind them: what looks like it may be of the frame.
            if (at_the_end && agreed_in_a_row_ == 0)
                drop_held();
            else
                settled_ = whole_;
            return;
        }
        if (start.octets == 0 || start.octets > rest.size()) return;
        whole_ += start.octets;
        if (certain || octets_.size() - whole_ >= doubtful_octets) settled_ = whole_;
    }
}

/// Whether the unfinished packet, of which the frames before had `begun` octets, ends where this frame, whose data
/// stand behind them, says that the next begins.
bool PacketExtractor::pointer_agrees(const TransferFrame& frame, std::size_t begun) const {
    std::size_t missing = 0;
    if (begun > 0) {
        const auto start = packet_start(std::span{octets_}.subspan(whole_));
        if (start.kind == PacketStart::Kind::unknown) return false;
        if (start.octets == 0) return frame.first_header_pointer == no_packet_begins;
        missing = start.octets - begun;
    }
    return frame.first_header_pointer == (missing < frame.data.size() ? missing : std::size_t{no_packet_begins});
}

/// Counts a pointer by whether it agrees.
void PacketExtractor::judge(const TransferFrame& frame, std::size_t begun, bool agrees) {
    if (agrees) {
        if (frame.first_header_pointer == no_packet_begins) return;  // says little
        ++pointers_.agreed;
        ++agreed_in_a_row_;
        contradicted_ = false;
        return;
    }
    ++pointers_.contradicted;
    agreed_in_a_row_ = 0;
    contradicted_ = true;
    const auto start = begun > 0 ? packet_start(std::span{octets_}.subspan(whole_)) : PacketStart{};
    if (start.octets < begun || frame.first_header_pointer == no_packet_begins) return;
    const auto shift =
        static_cast<std::int64_t>(frame.first_header_pointer) - static_cast<std::int64_t>(start.octets - begun);
    if (std::abs(shift) <= PointerVerdicts::shift_max)
        ++pointers_.shifts.at(static_cast<std::size_t>(shift + PointerVerdicts::shift_max));
}

void PacketExtractor::add(const TransferFrame& frame, FramePlace place, Ert received) {
    while (next()) {
    }
    if (place == FramePlace::repeated || !frame.packets ||
        (place == FramePlace::late && frame.first_header_pointer == only_idle_data))
        return;
    if (place == FramePlace::late) return add_late(frame, received);
    use(used_);
    for (Completed& each : completed_) each.end = std::min(each.end, whole_);
    if (place != FramePlace::next) {
        settle_held(trusts_pointers());
        forget_begun();
    }
    if (frame.first_header_pointer == only_idle_data) return settle_held(trusts_pointers());
    received_ = received;
    if (in_step_) {
        const std::size_t begun = begun_octets();
        octets_.insert(octets_.end(), frame.data.begin(), frame.data.end());
        const bool agrees = pointer_agrees(frame, begun);
        judge(frame, begun, agrees);
        if (agrees) {
            if (frame.first_header_pointer != no_packet_begins) settled_ = whole_;
            return find_whole();
        }
        octets_.resize(whole_ + begun);
        drop_held();
        forget_begun();
    }
    begin_at(frame);
}

void PacketExtractor::end() {
    while (next()) {
    }
    settle_held(trusts_pointers());
    if (begun_octets() > 0 && packet_start(std::span{octets_}.subspan(whole_)).kind != PacketStart::Kind::idle) {
        ++counters_.cut_packets;
        counters_.unreadable_octets += begun_octets();
    }
    octets_.clear();
    used_ = settled_ = whole_ = 0;
    completed_.clear();
    in_step_ = false;
}

/// A late frame's last packet goes on in a frame that is not there, or was used already.
void PacketExtractor::add_late(const TransferFrame& frame, Ert received) {
    const auto data = data_from_pointer(frame);
    counters_.unreadable_octets += frame.data.size() - data.size();
    early_.assign(data.begin(), data.end());
    early_used_ = 0;
    early_received_ = received;
    std::size_t whole = 0;
    while (whole < early_.size()) {
        const auto start = packet_start(std::span{early_}.subspan(whole));
        if (start.octets == 0 || start.octets > early_.size() - whole) break;
        if (!trusts_pointers() && early_.size() - whole - start.octets < doubtful_octets) break;
        whole += start.octets;
    }
    if (whole == early_.size()) return;
    const bool packet = packet_start(std::span{early_}.subspan(whole)).kind != PacketStart::Kind::unknown;
    if (packet) ++counters_.cut_packets;
    counters_.unreadable_octets += early_.size() - whole;
    early_.resize(whole);
}

std::optional<std::span<const std::uint8_t>> PacketExtractor::next() {
    if (const auto packet = next_in(early_, early_used_, early_.size())) {
        given_received_ = early_received_;
        return packet;
    }
    early_.clear();
    early_used_ = 0;
    const auto packet = next_in(octets_, used_, settled_);
    const auto by = std::ranges::find_if(completed_, [&](const Completed& each) { return used_ <= each.end; });
    if (packet && by != completed_.end()) given_received_ = by->received;
    return packet;
}

/// The next packet of whole ones that end at `end`.
std::optional<std::span<const std::uint8_t>> PacketExtractor::next_in(const std::vector<std::uint8_t>& octets,
                                                                      std::size_t& used, std::size_t end) {
    while (used < end) {
        const auto rest = std::span{octets}.subspan(used);
        const auto start = packet_start(rest);
        used += start.octets;
        if (counters_.count(start.kind)) return rest.first(start.octets);
    }
    return std::nullopt;
}

}  // namespace aeolis::telemetry
