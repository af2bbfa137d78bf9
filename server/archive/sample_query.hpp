// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/reader_state.hpp"
#include "server/archive/sample_walk.hpp"

#include <span>
#include <vector>

namespace aeolis::archive {

/// The data to read for a question about one channel and range of time.
struct SampleSources {
    struct Part {
        SealedSeries series;
        std::vector<NodeRange> node_ranges;
        std::vector<Sample> tail;  ///< in no segment yet: decommutated again from the packets
    };
    ChannelId channel;
    ClosedRange range;
    std::vector<Part> parts;
    std::size_t samples_at_most = 0;  ///< upper bound: nodes and segments that touch the range count whole
};
/// Finds the data of a channel in a range: mostly in sealed segments; later samples are decommutated again from the
/// packets, so that the answer holds everything durable without the writer's help. Call within a read transaction, and
/// use the result within the same.
/// @param only  only samples of this source; none: both
Result<SampleSources> find_sample_sources(Reader::State& reader, const RunInfo& run, ChannelId channel,
                                          const ClosedRange& range, std::optional<Source> only = std::nullopt);

/// The samples of one channel in a range, undefined ones (NaN) too, in order of SCLK, live and recorded as one series.
/// Those of one instant are in the order of reception, live ones first, whichever packets have them.
/// They are valid until the next call, because they are in a buffer that the reader reuses.
Result<std::span<const Sample>> exact_samples(Reader::State& reader, const SampleSources& sources);

struct Thinned {
    std::vector<Sample> points;
    std::uint64_t samples = 0;  ///< number of defined samples, which the points represent
};
/// Thins the defined samples to the minimum and maximum of each of `points` / 2 equal intervals, each at its own time.
/// Reads nodes of the pyramid (at least half as many as intervals) or, where those are too few, samples. The extremes
/// of the whole range are always among the points. A node on the border of two intervals may serve both.
Result<Thinned> thinned_samples(Reader::State& reader, const SampleSources& sources, std::size_t points);

}  // namespace aeolis::archive
