// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/records.hpp"

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

// The pyramid over a series (one packet from one source). Level 1 has one node per node_samples samples, in the order
// of receipt; each further level one per fan_out nodes of the level below. A node holds the time span of its samples
// and, for each channel, the extremes. Nodes are stored block_nodes at a time. A plot of any stretch then reads a few
// rows, and a range of time is found without reading every segment.
namespace aeolis::archive::pyramid {

inline constexpr std::uint64_t node_samples = 128;  ///< chosen: 8 nodes a segment; 0.3 octets a sample
inline constexpr std::uint64_t fan_out = 8;
inline constexpr std::uint64_t block_nodes = 256;
inline constexpr unsigned levels = 4;  ///< a block of the last level covers 16.8 million samples, 3 days at 64 Hz
static_assert(segment_samples % node_samples == 0 && block_nodes % fan_out == 0);

/// The samples that a node of a level covers; level 0: one sample.
constexpr std::uint64_t samples_of_node(unsigned level) {
    std::uint64_t samples = level == 0 ? 1 : node_samples;
    for (unsigned below = 1; below < level; ++below) samples *= fan_out;
    return samples;
}

/// The octets of one channel's node. A row holds all minima, their times, all maxima, their times (doubles), then the
/// numbers of defined samples (32 bits); little-endian.
inline constexpr std::size_t node_octets = 4 * sizeof(double) + sizeof(std::uint32_t);
std::vector<std::uint8_t> octets_of_nodes(std::span<const Extremes> nodes);
/// @param octets  a row of `nodes` nodes
Extremes node_of(std::span<const std::uint8_t> octets, std::size_t nodes, std::size_t index);

/// Builds the blocks of one run's series while its segments are written.
///
/// In       segments of each series in the order of their positions
/// Out      each block when full; at seal() the rest, where a row is worth it. The level below serves where a block is
///          absent
/// Memory   36 octets per node, at most block_nodes a level: 37 KB per channel of a series of millions of samples
class Builder {
  public:
    void add(const SegmentRecord& segment, std::vector<PyramidRecord>& full);
    void seal(std::vector<PyramidRecord>& out);

  private:
    struct Level {
        std::uint64_t position = 0;
        std::vector<double> first_sclk_s, last_sclk_s;
        std::vector<Extremes> nodes;  ///< node by node, channels.size() each
    };
    struct Series {
        std::vector<ChannelId> channels;
        std::array<Level, levels> of;  ///< level 1 first
    };
    using Key = std::pair<std::uint16_t, Source>;

    /// Emits a block and passes its nodes to the level above.
    static void close(const Key& key, Series& series, unsigned level, std::vector<PyramidRecord>& out);

    std::map<Key, Series> series_;
};

}  // namespace aeolis::archive::pyramid
