// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/reader_state.hpp"

#include <optional>
#include <vector>

// Samples decoded again from their packets, for what segments do not hold: exact texts, and the order of reception.
namespace aeolis::archive {

/// The newest sample of each channel, by ChannelId; none: no packet with the channel has been received.
using Newest = std::vector<std::optional<ChannelValue>>;

/// Updates `newest` with the values of a packet type's newest packet from one source, where they are newer. In our
/// mission the value with the later time is newer, because its only clock never goes back; in another mission, the
/// value received later. Call within a read transaction.
/// @param to_s  SCLK: later packets do not count
Result<void> note_newest(Reader::State& reader, const RunInfo& run, std::size_t packet, Source source, double to_s,
                         Newest& newest);

/// The samples in a range of a channel whose type needs_text(), in order of SCLK. Call within a read transaction.
/// @param only  only samples of this source; none: both
Result<std::vector<ChannelValue>> text_samples(Reader::State& reader, const RunInfo& run, ChannelId channel,
                                               const ClosedRange& range, std::optional<Source> only = std::nullopt);

/// The numbers of the packets of a type that gave samples in a range, in order of SCLK, at one instant of reception.
/// Call within a read transaction.
Result<std::vector<Sequence>> sequences_of_samples(Reader::State& reader, RunId run, std::size_t packet, Source source,
                                                   const ClosedRange& range);

}  // namespace aeolis::archive
