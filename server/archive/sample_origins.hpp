// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/reader_state.hpp"

namespace aeolis::archive {

/// Adds to a series the origins of its samples and its gaps. Reads each packet that carries the channel. Call within a
/// read transaction.
///
/// Origin   consecutive samples, in order of SCLK, of one source (real time or recorded) and one link, whose packets
///          have one verdict against the other path
/// Gap      longer than `stale_intervals` of the slowest interval at which the plan promises the channel's packet, or
///          with values between that were undefined on board. At an end of the range only if that end was given
/// Reason   the reported reason while the live link was down, if that lies in the gap; else unknown, as always for the
///          recording alone
/// Limits   exact_samples_max packets
/// @param asked  the range as requested; `range` is the same, closed
/// @param only   only samples of this source; none: both
Result<void> add_origins(Reader::State& reader, const RunInfo& run, ChannelId channel, const SclkRange& asked,
                         const ClosedRange& range, std::optional<Source> only, v1::ChannelSeries& series);

}  // namespace aeolis::archive
