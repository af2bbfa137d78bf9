// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"

#include <array>
#include <cstdint>

namespace aeolis::telemetry {

/// What a link brought so far. Every octet received is counted once: in a good unit, or as skipped.
struct LinkCounters {
    std::uint64_t octets = 0;
    std::uint64_t frames = 0;           ///< whole, with a good CRC
    std::uint64_t bad_crc = 0;          ///< a marker with a possible header and a wrong CRC behind it
    std::uint64_t bad_header = 0;       ///< a marker with something else than a header behind it
    std::uint64_t skipped_octets = 0;   ///< between good units
    std::uint64_t gaps = 0;             ///< places where the frame sequence is not the next
    std::uint64_t missing_frames = 0;   ///< by the frame sequence: a multiple of its modulus cannot be seen
    std::uint64_t repeated_frames = 0;  ///< with the sequence of the one before

    bool operator==(const LinkCounters&) const = default;
};

/// Whether the frames of one stream follow each other.
class SequenceGaps {
  public:
    /// `modulus` is a power of two. Counts into `counters`; returns how many frames are missing before this one.
    std::uint32_t next(std::uint32_t sequence, std::uint32_t modulus, LinkCounters& counters);

  private:
    std::uint32_t expected_ = 0;
    bool begun_ = false;
};

/// Something a second, over the last ten whole seconds.
class RateMeter {
  public:
    static constexpr std::int64_t seconds = 10;

    /// `amount` at `at`; what is older than what came before counts with the newest.
    void add(Ert at, std::uint64_t amount);
    /// Mean of the ten whole seconds before that of `now`.
    double per_second(Ert now) const;

  private:
    static constexpr std::size_t places = seconds + 1;
    std::array<std::uint64_t, places> amounts_{};
    std::int64_t newest_s_ = 0;
};

}  // namespace aeolis::telemetry
