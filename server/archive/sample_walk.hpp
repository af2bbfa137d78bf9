// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/pyramid.hpp"
#include "server/archive/reader_state.hpp"

#include <array>
#include <vector>

// Finds the samples, and the nodes of the pyramid over them, in a range of time.
namespace aeolis::archive {

/// One packet's samples from one source in the order of receipt, as far as they are in segments.
struct SealedSeries {
    RunId run;
    std::uint16_t packet = 0;
    Source source{};
    Sequence last_packet_seq = 0;  ///< 0: no segment yet
    /// Number of stored nodes by level; level 0: samples. Samples beyond the last node of a level are in the level
    /// below.
    std::array<std::uint64_t, pyramid::levels + 1> nodes{};

    /// Binds run, packet and source to parameters 1, 2, 3.
    void bind(sqlite::Statement& statement) const;
};
Result<SealedSeries> sealed_series(Reader::State& reader, RunId run, std::uint16_t packet, Source source);

/// Nodes first … last - 1 of a level, with all their samples in the range; at level 0 samples, some perhaps outside.
struct NodeRange {
    unsigned level = 0;
    std::uint64_t first = 0, last = 0;
};
/// The node ranges of a series in a range of time, in order. They hold each sample once, at the highest possible level.
Result<std::vector<NodeRange>> node_ranges(Reader::State& reader, const SealedSeries& series, const ClosedRange& range);

}  // namespace aeolis::archive
