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

void PltuReceiver::skip(std::size_t octets) {
    stray_.skipped(window_.rest().first(octets));
    window_.use(octets);
    counters_.skipped_octets += octets;
}

std::optional<PltuReceiver::Received> PltuReceiver::next() {
    while (true) {
        skip(find_octet(window_.rest(), pltu_marker.front()));
        const auto rest = window_.rest();
        if (rest.empty()) return std::nullopt;
        const std::size_t seen = std::min(rest.size(), pltu_marker.size());
        if (!std::equal(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(seen), pltu_marker.begin())) {
            skip(1);
            continue;
        }
        const auto length =
            seen < pltu_marker.size() ? Malformed::too_short : proximity_frame_octets(rest.subspan(pltu_marker.size()));
        const bool cut = length ? rest.size() < pltu_marker.size() + *length + pltu_crc_octets
                                : length.why() == Malformed::too_short;
        if (cut && !ended_) return std::nullopt;
        if (cut || !length) {
            if (!cut) ++counters_.bad_header;
            skip(seen);
            continue;
        }
        const std::size_t size = pltu_marker.size() + *length + pltu_crc_octets;
        const auto frame = read_pltu(rest.first(size));
        if (!frame) {
            ++counters_.bad_crc;
            skip(seen);
            continue;
        }
        window_.use(size);
        ++counters_.frames;
        stray_.frame();
        const ProximityHeader& header = frame->header;
        const std::uint32_t stream = header.spacecraft * 4U + header.physical_channel * 2U + header.expedited;
        Stream& counted = streams_[stream];
        const auto placed = counted.order.place(header.sequence, 256, rest.first(size), counted.counters);
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
