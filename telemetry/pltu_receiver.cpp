// SPDX-License-Identifier: Apache-2.0
#include "telemetry/pltu_receiver.hpp"

#include <algorithm>
#include <string>

namespace aeolis::telemetry {

void PltuReceiver::receive(std::span<const std::uint8_t> octets) {
    ended_ = false;
    window_.add(octets);
    counters_.octets += octets.size();
}

/// Counts what of the skipped octets, which the window still begins with, is no fill.
void PltuReceiver::skip_to_stray(std::size_t octets) {
    const auto rest = window_.rest();
    if (alignment_ == BitAlignment{}) return stray_.skipped(rest.first(octets));
    // The bits of an octet that nothing follows only fill it up.
    const bool is_last = alignment_.shift > 0 && rest.size() == octets;
    std::vector<std::uint8_t> sent;
    align(rest, 0, octets - (is_last && octets > 0 ? 1 : 0), alignment_, sent);
    stray_.skipped(sent);
}

void PltuReceiver::skip(std::size_t octets) {
    if (!aligned_ && first_.size() + octets > first_octets_max) begin_alignment({});
    const auto skipped = window_.rest().first(octets);
    if (aligned_)
        skip_to_stray(octets);
    else
        first_.insert(first_.end(), skipped.begin(), skipped.end());
    window_.use(octets);
    counters_.skipped_octets += octets;
}

/// Counts the first octets by how bits lie in them.
void PltuReceiver::begin_alignment(const BitAlignment& alignment) {
    alignment_ = alignment;
    aligned_ = true;
    std::vector<std::uint8_t> sent;
    if (alignment.shift > 0) {
        const auto rest = window_.rest();
        first_.push_back(rest.empty() ? std::uint8_t{0} : rest.front());
    }
    align(first_, 0, first_.size() - (alignment.shift > 0 ? 1 : 0), alignment, sent);
    stray_.skipped(sent);
    first_ = {};
}

std::uint64_t PltuReceiver::stray_octets() const {
    StrayOctets stray = stray_;
    stray.skipped(first_);
    return stray.number();
}

std::optional<PltuReceiver::Received> PltuReceiver::next() {
    while (true) {
        const std::size_t waits = ended_ ? 0 : std::min(window_.rest().size(), pltu_marker.size());
        const auto found = find_pltu_marker(window_.rest(), 0);
        skip(found ? found->octet : window_.rest().size() - waits);
        if (!found) return std::nullopt;
        const auto rest = window_.rest();
        const bool as_before = found->alignment == alignment_;
        const std::size_t of_shift = found->alignment.shift > 0 ? 1 : 0;
        const auto sent = [&](std::size_t octets) {
            if (found->alignment == BitAlignment{}) return rest.first(octets);
            align(rest, 0, octets, found->alignment, pltu_);
            return std::span<const std::uint8_t>{pltu_};
        };
        const std::size_t header = std::min(rest.size() - of_shift, pltu_marker.size() + proximity_header_octets);
        const auto length = proximity_frame_octets(sent(header).subspan(pltu_marker.size()));
        const std::size_t size = pltu_marker.size() + (length ? *length : 0) + pltu_crc_octets;
        const bool cut = length ? rest.size() < size + of_shift : length.why() == Malformed::too_short;
        if (cut && !ended_) return std::nullopt;
        const std::size_t no_frame = as_before ? pltu_marker.size() : 1;
        if (cut || !length) {
            if (!cut && as_before) ++counters_.bad_header;
            skip(no_frame);
            continue;
        }
        const auto octets = sent(size);
        const auto frame = read_pltu(octets);
        if (!frame) {
            if (as_before) ++counters_.bad_crc;
            skip(no_frame);
            continue;
        }
        if (!aligned_) begin_alignment(found->alignment);
        if (!as_before && counters_.frames > 0) ++counters_.slips;
        alignment_ = found->alignment;
        window_.use(size);
        ++counters_.frames;
        stray_.frame();
        const ProximityHeader& header_fields = frame->header;
        const std::uint32_t stream =
            header_fields.spacecraft * 4U + header_fields.physical_channel * 2U + header_fields.expedited;
        Stream& counted = streams_[stream];
        const auto placed = counted.order.place(header_fields.sequence, 256, octets, counted.counters);
        if (placed.place != FramePlace::repeated) return Received{*frame, placed.place};
    }
}

LinkCounters PltuReceiver::counters() const {
    LinkCounters sum = counters_;
    for (const auto& [id, stream] : streams_) sum += stream.counters;
    return sum;
}

std::vector<SequenceTotals> PltuReceiver::sequences() const {
    std::vector<SequenceTotals> totals;
    totals.reserve(streams_.size());
    for (const auto& [id, stream] : streams_)
        totals.push_back({"spacecraft " + std::to_string(id / 4) + ", physical channel " + std::to_string(id / 2 % 2) +
                              (id % 2 != 0 ? ", expedited" : ", sequence controlled"),
                          false, stream.counters});
    return totals;
}

}  // namespace aeolis::telemetry
