// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/link_counters.hpp"

#include <array>
#include <cstdint>
#include <span>

namespace aeolis::telemetry {

/// Where a frame stands in the sequence of its channel.
enum class FramePlace : std::uint8_t {
    next,       ///< continues the frame before it, or is the first
    after_gap,  ///< frames before it are missing
    repeated,   ///< the same frame was received before: its data must not be used twice
    late,       ///< was missing, and belongs before frames that were received already
    restarted,  ///< the count began anew: what it continues is not known
};

/// Orders the frames of one channel, or the packets of one id, by their count.
///
/// Rule     a count within the last `window_max` frames, or a quarter of the modulus, is an earlier frame: repeated
///          when its octets are those received with that count, restarted when they differ, late when none was
///          received. A count of more than 8 bits that goes back further is restarted. Everything else is a gap
/// Limits   an outage of a whole modulus goes unnoticed; of a count of 8 bits, up to a quarter of it looks late
class FrameOrder {
  public:
    static constexpr std::uint32_t window_max = 64;  ///< chosen: what stations and recorders are known to reorder

    struct Placed {
        FramePlace place = FramePlace::next;
        std::uint32_t missing = 0;  ///< frames before it, of after_gap
    };
    /// Finds the place of a frame in its sequence, and counts it in `counters`. @param modulus of the count, a power of
    /// two @param octets of the whole frame
    Placed place(std::uint32_t count, std::uint32_t modulus, std::span<const std::uint8_t> octets,
                 SequenceCounters& counters);

  private:
    struct Seen {
        std::uint64_t index = 0;  ///< 0: none
        std::size_t hash = 0;
    };
    void begin(std::uint32_t count, std::uint32_t modulus, std::size_t hash);
    Placed place_earlier(std::uint64_t index, std::uint32_t count, std::uint32_t modulus, std::size_t hash,
                         SequenceCounters& counters);

    std::uint64_t first_ = 0, last_ = 0;  ///< counts without their wrap; 0: none yet
    std::array<Seen, window_max> seen_{};
};

}  // namespace aeolis::telemetry
