// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/space_packet.hpp"
#include "common/tm_frame.hpp"
#include "telemetry/frame_order.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace aeolis::telemetry {

/// Counters of packets in frame data.
struct PacketCounters {
    std::uint64_t packets = 0;                ///< returned
    std::uint64_t idle_packets = 0;           ///< APID 7FF, or encapsulation packets of protocol 0: fill, not returned
    std::uint64_t encapsulation_packets = 0;  ///< of another protocol: not returned
    std::uint64_t cut_packets = 0;            ///< started, never completed
    std::uint64_t lost_segments = 0;          ///< parts of packets that could not be put together
    std::uint64_t unreadable_octets = 0;      ///< octets outside readable packets

    /// Counts a packet. @return whether it is a space packet to be returned
    bool count(PacketStart::Kind kind);
    PacketCounters& operator+=(const PacketCounters& other);
    bool operator==(const PacketCounters&) const = default;
};

/// Extracts space packets from the frames of one virtual channel, across frames, by the first header pointer.
///
/// In       frames as received, each with its place in the sequence              Out   whole space packets, of any
///          mission
/// Memory   one packet and one frame
/// Faults   a missing frame, or a pointer that contradicts the packet before it, loses the unfinished packet;
///          extraction resumes at the next pointer. Of a late frame the packets that it holds whole are returned
class PacketExtractor {
  public:
    void add(const TransferFrame& frame, FramePlace place);

    /// The next whole packet; valid until the next add().
    std::optional<std::span<const std::uint8_t>> next();
    /// Ends the channel: a packet that was begun is cut; fill is not.
    void end();

    const PacketCounters& counters() const { return counters_; }

  private:
    void forget_begun();
    void begin_at(const TransferFrame& frame);
    void add_late(const TransferFrame& frame);
    std::optional<std::span<const std::uint8_t>> next_in(const std::vector<std::uint8_t>& octets, std::size_t& used);
    bool pointer_agrees(const TransferFrame& frame) const;

    std::vector<std::uint8_t> late_;  ///< of a late frame, from the start of a packet; it is read first
    std::size_t late_used_ = 0;
    std::vector<std::uint8_t> octets_;  ///< from the start of a packet
    std::size_t used_ = 0;
    std::size_t begun_octets_ = 0;  ///< size of the packet that the last frame left unfinished
    bool in_step_ = false;
    PacketCounters counters_;
};

}  // namespace aeolis::telemetry
