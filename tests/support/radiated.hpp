// SPDX-License-Identifier: Apache-2.0
// The packets in radiated PLTUs.
#pragma once

#include "telemetry/proximity_packets.hpp"
#include "tests/support/catch.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace aeolis::test {

/// Splits PLTUs, which must be whole and without faults.
inline std::vector<std::vector<std::uint8_t>> packets_in_pltus(std::span<const std::uint8_t> pltus) {
    std::vector<std::vector<std::uint8_t>> found;
    telemetry::PltuReceiver receiver;
    telemetry::ProximityPackets packets;
    receiver.receive(pltus);
    while (const auto frame = receiver.next()) {
        packets.add(*frame);
        while (const auto packet = packets.next()) found.emplace_back(packet->begin(), packet->end());
    }
    REQUIRE(receiver.counters().skipped_octets == 0);
    REQUIRE(receiver.counters().octets == pltus.size());
    return found;
}

}  // namespace aeolis::test
