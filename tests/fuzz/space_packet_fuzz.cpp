// SPDX-License-Identifier: Apache-2.0
// Octets from a link, as packets: whatever they are, nothing outside them is read and nothing ends the program.
#include "common/space_packet.hpp"
#include "telemetry/packet_stream.hpp"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::span octets{data, size};
    (void)aeolis::read_tm_packet(octets);
    (void)aeolis::read_tc_packet(octets);
    (void)aeolis::space_packet_octets(octets);

    aeolis::telemetry::PacketStream stream{octets};
    std::size_t read = 0;
    while (const auto packet = stream.next()) {
        read += packet->size();
        (void)aeolis::read_tm_packet(*packet);
        (void)aeolis::read_tc_packet(*packet);
    }
    if (read + stream.unreadable_octets() != size) {
        std::abort();  // something was skipped in silence
    }
    return 0;
}
