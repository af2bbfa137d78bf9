// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/tm_frame.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace aeolis::telemetry {

/// What became of the data of frames.
struct PacketCounters {
    std::uint64_t packets = 0;            ///< given out
    std::uint64_t idle_packets = 0;       ///< APID 7FF: fill, not given out
    std::uint64_t cut_packets = 0;        ///< begun, and never completed
    std::uint64_t unreadable_octets = 0;  ///< that belong to no packet that could be read

    bool operator==(const PacketCounters&) const = default;
};

/// Space packets out of the frames of one virtual channel, across frames, by the first header pointer.
///
/// In       frames in order, each with whether one is missing before it    Out   whole packets, of any mission
/// Memory   one packet and one frame
/// Faults   a missing frame, or a pointer that contradicts the packet before it, costs the packet that was begun; it
///          goes on where the next pointer says that a packet begins
class PacketExtractor {
  public:
    void add(const TransferFrame& frame, bool missing_before);

    /// The next whole packet; its octets are good until the next add().
    std::optional<std::span<const std::uint8_t>> next();

    const PacketCounters& counters() const { return counters_; }

  private:
    void forget_begun();
    void begin_at(const TransferFrame& frame);
    bool pointer_agrees(const TransferFrame& frame) const;

    std::vector<std::uint8_t> octets_;  ///< from the beginning of a packet
    std::size_t used_ = 0;
    std::size_t begun_octets_ = 0;  ///< of the packet that the last frame left unfinished
    bool in_step_ = false;
    PacketCounters counters_;
};

}  // namespace aeolis::telemetry
