// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace aeolis::telemetry {

/// Reassembles data that a sender divided into several space packets, by their sequence flags. [ccsds-133.0-b-2,
/// 4.1.3.4.2]
///
/// In       space packets of any mission, in order          Out   unsegmented packets as they came; segments as one
///          packet: the first one's header, marked unsegmented, and the data fields of all
/// Memory   unfinished_max packets of 65542 octets each at most
/// Faults   counted, and nothing is given out: a count missing or repeated between two segments, a segment without a
///          first one, a first one before the last, more data than a packet can have, a secondary header in a later
///          segment, whose length is not known
class SegmentAssembler {
  public:
    static constexpr std::size_t unfinished_max = 64;  ///< chosen; of more, the one with the least key is given up

    /// The whole packet, if there is one now; valid until the next call.
    /// @param channel  on which it was received: segments of two channels never make one packet
    std::optional<std::span<const std::uint8_t>> add(std::span<const std::uint8_t> packet, std::uint32_t channel = 0);
    /// Gives up unfinished packets.
    void end();
    std::uint64_t lost_segments() const { return lost_; }

  private:
    struct Begun {
        std::vector<std::uint8_t> octets;
        std::uint64_t segments = 0;
        std::uint16_t count = 0;  ///< of the last segment
    };
    using Key = std::pair<std::uint32_t, std::uint16_t>;  ///< channel, and APID with the packet's type
    void give_up(const Key& key);

    std::map<Key, Begun> begun_;
    std::vector<std::uint8_t> whole_;
    std::uint64_t lost_ = 0;
};

}  // namespace aeolis::telemetry
