#pragma once

#include "server/archive/packet_columns.hpp"
#include "server/archive/records.hpp"

#include <array>
#include <span>
#include <vector>

namespace aeolis::pipeline {

/// Collects the samples of one run, packet by packet and source by source, into segments of `samples_max`.
///
/// In       sampled units in the order of their sequence numbers
/// Out      a segment whenever one is full; the rest at seal()
/// Memory   8 octets a value, at most samples_max samples a packet and source: some 2 MB for the mission's dictionary
class SegmentBuilder {
  public:
    SegmentBuilder(const archive::PacketColumns& columns, std::size_t samples_max);

    void add(std::uint16_t packet, archive::Source source, archive::Sequence unit, Sclk sclk,
             std::span<const double> values, std::vector<archive::SegmentRecord>& full);
    /// Everything that is not yet in a segment.
    void seal(std::vector<archive::SegmentRecord>& out);

  private:
    struct Open {
        archive::Sequence first_unit = 0, last_unit = 0;
        std::vector<double> sclk_s;
        std::vector<double> values; ///< samples_max to a channel
    };
    archive::SegmentRecord take(std::size_t packet, archive::Source source, Open& open) const;

    static constexpr std::size_t sources = 2; ///< realtime, recorded
    const archive::PacketColumns& columns_;
    std::size_t samples_max_;
    std::vector<std::array<Open, sources>> open_; ///< by packet
};

} // namespace aeolis::pipeline
