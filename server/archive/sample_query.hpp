// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/reader_state.hpp"
#include "server/archive/sample_walk.hpp"

#include <span>
#include <vector>

namespace aeolis::archive {

/// What a question about one channel and range of time has to read.
struct Coverage {
    struct Part {
        SealedSeries series;
        std::vector<Stretch> stretches;
    };
    ChannelId channel;
    ClosedRange range;
    std::vector<Part> parts;
    std::vector<Sample> tail;         ///< of no segment yet: made again from the raw units
    std::size_t samples_at_most = 0;  ///< nodes and segments that only touch the range count whole
};
/// Sealed segments hold most; what came after the last of them is made again from the raw units, so that the answer is
/// everything durable without the writer's help. Call within a read transaction, and use it within the same.
/// @param only  what came so; none: both sources
Result<Coverage> cover(Reader::State& reader, const RunInfo& run, ChannelId channel, const ClosedRange& range,
                       std::optional<Source> only = std::nullopt);

/// The samples of one channel in a range, defined ones only, in order of SCLK, live and recorded as one series. Valid
/// until the next question: they stand in the reader's memory, which is not asked of the kernel anew for each.
Result<std::span<const Sample>> exact_samples(Reader::State& reader, const Coverage& coverage);

struct Thinned {
    std::vector<Sample> points;
    std::uint64_t samples = 0;  ///< that the points stand for
};
/// The range in `points` / 2 equal intervals, each with the least and the largest of what falls into it, each at its
/// own time: nodes of the pyramid, at least half as many as intervals, or, where there are too few of them, samples. An
/// extreme of all is always among the points; at the border of two intervals one node may speak for both.
Result<Thinned> thinned_samples(Reader::State& reader, const Coverage& coverage, std::size_t points);

}  // namespace aeolis::archive
