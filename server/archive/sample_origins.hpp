// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/reader_state.hpp"

namespace aeolis::archive {

/// Adds to a series where all samples of the range came from and where there are none, by looking at each packet that
/// the channel comes in. Call within a read transaction.
///
/// Origin   samples in a row, in order of SCLK, that came in real time or recorded, over one link, and whose packets
///          have one verdict against the other path
/// Gap      longer than `stale_intervals` of the slowest interval at which the plan promises the channel's packet, or
///          with values between that were undefined on board. At an end of the range only where that end was asked for
/// Reason   what was told of the link that is live while it was down, where that lies in the gap; else not known, and
///          always so of the recording alone
/// Limits   exact_samples_max packets
/// @param asked  with the ends that were asked for; `range` the same, closed
/// @param only  what came so; none: both sources
Result<void> add_origins(Reader::State& reader, const RunInfo& run, ChannelId channel, const SclkRange& asked,
                         const ClosedRange& range, std::optional<Source> only, v1::ChannelSeries& series);

}  // namespace aeolis::archive
