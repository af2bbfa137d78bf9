// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/packet_extractor.hpp"

#include <cstdint>

namespace aeolis::server {

/// Tells when a file has nothing but segments that belong to no packet, as the zeros of a file that is not stored, or
/// not of packets, are read: 7 octets each, without an end.
class UselessSegments {
  public:
    static constexpr std::uint64_t in_a_row_max = 100'000;  ///< chosen: of a packet that lost its first, 6.5 GB

    /// Takes the counts so far. True: more than in_a_row_max came since the last packet that was of use.
    bool add(const telemetry::PacketCounters& counted) {
        const std::uint64_t useful =
            counted.packets - counted.lost_segments + counted.idle_packets + counted.encapsulation_packets;
        if (useful != useful_) {
            useful_ = useful;
            lost_before_ = counted.lost_segments;
        }
        return counted.lost_segments - lost_before_ > in_a_row_max;
    }

  private:
    std::uint64_t useful_ = 0, lost_before_ = 0;
};

}  // namespace aeolis::server
