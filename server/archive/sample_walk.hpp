// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/pyramid.hpp"
#include "server/archive/reader_state.hpp"

#include <array>
#include <vector>

// Which samples, and which nodes of the pyramid over them, a range of time holds.
namespace aeolis::archive {

/// One packet's samples from one source, in the order of receipt; as far as they are in segments.
struct SealedSeries {
    RunId run;
    std::uint16_t packet = 0;
    Source source{};
    Sequence last_unit = 0;  ///< 0: no segment yet
    /// Stored nodes by level; level 0: samples. What a level does not reach is in the one below.
    std::array<std::uint64_t, pyramid::levels + 1> nodes{};

    /// Run, packet and source to parameters 1, 2, 3.
    void bind(sqlite::Statement& statement) const;
};
Result<SealedSeries> sealed_series(Reader::State& reader, RunId run, std::uint16_t packet, Source source);

/// Nodes first … last - 1 of a level, all of whose samples lie in the range; at level 0 samples, of which some may not.
struct Stretch {
    unsigned level = 0;
    std::uint64_t first = 0, last = 0;
};
/// All samples of a series in a range, each in one stretch, of the highest level that it can be in; in order.
Result<std::vector<Stretch>> stretches(Reader::State& reader, const SealedSeries& series, const ClosedRange& range);

}  // namespace aeolis::archive
