// SPDX-License-Identifier: Apache-2.0
// A UHF stream of any octets: each is used or counted as skipped, and what comes out can be taken apart. The first
// octet says how the stream is cut into pieces; where the second is odd, good frames are put around pieces of it.
#include "telemetry/proximity_packets.hpp"

#include <algorithm>
#include <cstdlib>
#include <vector>

namespace {

std::vector<std::uint8_t> framed(std::span<const std::uint8_t> octets) {
    std::vector<std::uint8_t> stream;
    while (octets.size() >= 4) {
        const std::size_t size = std::min<std::size_t>(octets[0] + std::size_t{1}, octets.size() - 3);
        const aeolis::ProximityHeader header{(octets[1] & 1) != 0,
                                             (octets[1] & 0x80) != 0,
                                             static_cast<aeolis::Construction>((octets[1] >> 1) & 3),
                                             static_cast<std::uint16_t>(octets[1] >> 4),
                                             0,
                                             0,
                                             false,
                                             octets[2]};
        std::vector<std::uint8_t> pltu(aeolis::pltu_octets_max);
        pltu.resize(aeolis::write_pltu(header, octets.subspan(3, size), pltu));
        stream.insert(stream.end(), pltu.begin(), pltu.end());
        octets = octets.subspan(3 + size);
    }
    stream.insert(stream.end(), octets.begin(), octets.end());
    return stream;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 2) return 0;
    const std::size_t piece = data[0] + std::size_t{1};
    const std::span<const std::uint8_t> given{data + 2, size - 2};
    const auto stream = (data[1] & 1) != 0 ? framed(given) : std::vector<std::uint8_t>{given.begin(), given.end()};
    aeolis::telemetry::PltuReceiver receiver;
    aeolis::telemetry::ProximityPackets packets;
    std::size_t used = 0;
    const auto take = [&] {
        while (const auto received = receiver.next()) {
            used += received->frame.data.size() + aeolis::pltu_overhead_octets;
            packets.add(*received);
            while (const auto packet = packets.next())
                if (packet->size() <= 6) std::abort();
        }
    };
    for (std::size_t at = 0; at < stream.size(); at += piece) {
        receiver.receive(std::span{stream}.subspan(at, std::min(piece, stream.size() - at)));
        take();
    }
    receiver.end();
    take();
    // Every octet is given out, skipped, or of a frame that was received before: none is skipped in silence.
    const auto& counted = receiver.counters();
    const auto repeated = counted.repeated_frames;
    const std::size_t told = used + counted.skipped_octets + repeated * aeolis::pltu_overhead_octets;
    if (told > stream.size() || (repeated == 0 && told != stream.size())) std::abort();
    return 0;
}
