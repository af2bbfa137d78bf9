// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/packet_extractor.hpp"
#include "telemetry/pltu_receiver.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace aeolis::telemetry {

/// Extracts space packets from Proximity-1 frames, whole or in segments over several frames.
///
/// In       frames in order, of any number of spacecraft      Out   whole packets, of any mission
/// Memory   one packet for each pseudo packet id in use, 65542 octets each at most; the packets of one frame
/// Faults   a missing frame loses the unfinished segmented packets of its stream; of a late frame only whole packets
///          are used; supervisory frames, and data that are not packets, are only counted
class ProximityPackets {
  public:
    void add(const PltuReceiver::Received& received);

    /// The next whole packet; valid until the next add().
    std::optional<std::span<const std::uint8_t>> next();

    const PacketCounters& counters() const { return counters_; }
    std::uint64_t other_frames() const { return other_frames_; }  ///< supervisory, or without packets

  private:
    using StreamId = std::uint32_t;
    void split(std::span<const std::uint8_t> packets);
    void add_segment(StreamId stream, std::span<const std::uint8_t> segment);
    void give_out(const PacketStart& start, std::span<const std::uint8_t> packet);
    void forget(StreamId stream);

    std::map<StreamId, std::map<std::uint8_t, std::vector<std::uint8_t>>> begun_;
    std::deque<std::vector<std::uint8_t>> whole_;
    std::vector<std::uint8_t> given_;
    PacketCounters counters_;
    std::uint64_t other_frames_ = 0;
};

}  // namespace aeolis::telemetry
