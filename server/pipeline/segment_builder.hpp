// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/packet_columns.hpp"
#include "server/archive/pyramid.hpp"
#include "server/archive/records.hpp"

#include <array>
#include <span>
#include <vector>

namespace aeolis::pipeline {

/// Collects a run's samples into segments, by packet and source, and builds the pyramid. A full segment has
/// archive::segment_samples.
///
/// In       sampled packets in the order of their sequence numbers
/// Out      each segment when full, with the pyramid blocks that it fills; the rest at seal()
/// Memory   8 octets a value, at most segment_samples per packet and source: about 2 MB for the mission's dictionary,
///          given over to the batch with a full segment; and the pyramid's open blocks
class SegmentBuilder {
  public:
    explicit SegmentBuilder(const archive::PacketColumns& columns);

    /// Adds a packet's samples; full segments and blocks go to the batch.
    void add(std::uint16_t packet, archive::Source source, archive::Sequence packet_seq, Sclk sclk,
             std::span<const double> values, archive::Batch& batch);
    /// Adds to the batch all samples not yet in a segment.
    void seal(archive::Batch& batch);

  private:
    struct Open {
        archive::Sequence first_packet_seq = 0, last_packet_seq = 0;
        std::uint64_t position = 0;
        std::vector<double> sclk_s;
        std::vector<double> values;  ///< segment_samples per channel
    };
    void close(std::size_t packet, archive::Source source, Open& open, archive::Batch& batch);

    static constexpr std::size_t sources = 2;  ///< realtime, recorded
    const archive::PacketColumns& columns_;
    std::vector<std::array<Open, sources>> open_;  ///< by packet
    archive::pyramid::Builder pyramid_;
};

}  // namespace aeolis::pipeline
