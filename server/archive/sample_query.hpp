#pragma once

#include "server/archive/reader_state.hpp"

#include <vector>

namespace aeolis::archive {

struct Sample {
    double sclk_s = 0.0;
    double value = 0.0;
    Source source{};
};

/// The samples of one channel in a range, defined ones only, in order of SCLK, live and recorded as one series.
///
/// Sealed segments hold most; what came after the last of them is made again from the raw units, so that the answer is
/// everything durable without the writer's help. Call within a read transaction.
Result<std::vector<Sample>> exact_samples(Reader::State& reader, const RunInfo& run, ChannelId channel,
                                          const ClosedRange& range);

/// How many samples the range holds at most: segments that only touch it count whole.
Result<std::size_t> samples_at_most(Reader::State& reader, const RunInfo& run, ChannelId channel,
                                    const ClosedRange& range);

struct Thinned {
    std::vector<Sample> points;
    std::uint64_t samples = 0; ///< that the points stand for
};
/// The least and the largest sample of each of `points` / 2 equal intervals, each at its own time. A segment that lies
/// within one interval is not read: its row tells.
Result<Thinned> thinned_samples(Reader::State& reader, const RunInfo& run, ChannelId channel, const ClosedRange& range,
                                std::size_t points);

} // namespace aeolis::archive
