// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/records.hpp"

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

// The pyramid over a series (one packet from one source): level 1 has a node for each node_samples samples, in the
// order of receipt, each further level one for fan_out nodes of the level below. A node tells the span of its samples
// in time and, for each channel, their extremes. Nodes are stored block_nodes at a time: so a plot of any stretch reads
// a few rows, and a range of time is found without looking at every segment.
namespace aeolis::archive::pyramid {

inline constexpr std::uint64_t node_samples = 128;  ///< ours: 8 nodes a segment; 0.3 octets a sample
inline constexpr std::uint64_t fan_out = 8;
inline constexpr std::uint64_t block_nodes = 256;
inline constexpr unsigned levels = 4;  ///< a block of the last one stands for 16.8 million samples, 3 days at 64 Hz
static_assert(segment_samples % node_samples == 0 && block_nodes % fan_out == 0);

/// Samples that a node of a level stands for; level 0: a sample.
constexpr std::uint64_t samples_of_node(unsigned level) {
    std::uint64_t samples = level == 0 ? 1 : node_samples;
    for (unsigned below = 1; below < level; ++below) samples *= fan_out;
    return samples;
}

/// Nodes of one channel as a row has them: all least values, their times, all largest values, their times (doubles),
/// and numbers of defined samples (32 bits); little-endian.
inline constexpr std::size_t node_octets = 4 * sizeof(double) + sizeof(std::uint32_t);
std::vector<std::uint8_t> octets_of_nodes(std::span<const Extremes> nodes);
/// @param octets  of `nodes` of them
Extremes node_of(std::span<const std::uint8_t> octets, std::size_t nodes, std::size_t index);

/// Makes the blocks of one run's series as its segments are written.
///
/// In       segments of each series in the order of their positions
/// Out      a block whenever one is full; at seal() the rest, where it is worth a row: a block not written is made good
///          by what lies below it
/// Memory   36 octets a node, block_nodes a level at most: 37 KB a channel of a series of millions of samples
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

    /// Hands over a block, and its nodes to the level above.
    static void close(const Key& key, Series& series, unsigned level, std::vector<PyramidRecord>& out);

    std::map<Key, Series> series_;
};

}  // namespace aeolis::archive::pyramid
