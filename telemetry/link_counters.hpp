// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"

#include <array>
#include <cstdint>
#include <string>

namespace aeolis::telemetry {

/// Counters of one sequence: the frames of a virtual channel, or the packets of an id.
struct SequenceCounters {
    std::uint64_t received = 0;  ///< also repeated ones
    std::uint64_t gaps = 0;      ///< counts that do not continue the last
    std::uint64_t missing = 0;   ///< by the count; multiples of its modulus go unnoticed
    std::uint64_t repeated = 0;  ///< received before
    std::uint64_t late = 0;      ///< received after later ones; no longer missing
    std::uint64_t restarts = 0;  ///< the count began anew
    std::uint64_t wraps = 0;     ///< the count went from its largest value on to 0

    SequenceCounters& operator+=(const SequenceCounters& other);
    bool operator==(const SequenceCounters&) const = default;
};

/// A sequence by name, such as "spacecraft 76, virtual channel 1" or "virtual channel 1, APID 291".
struct SequenceTotals {
    std::string name;
    bool packets = false;  ///< of packets; false: of frames
    SequenceCounters counters;
};

/// Counters of a link's reception. Every received octet counts once: in a good frame, or as skipped.
struct LinkCounters {
    std::uint64_t octets = 0;
    std::uint64_t frames = 0;           ///< whole, with a good CRC
    std::uint64_t bad_crc = 0;          ///< marker and possible header, but a wrong CRC
    std::uint64_t bad_header = 0;       ///< marker without a valid header
    std::uint64_t skipped_octets = 0;   ///< between good frames
    std::uint64_t gaps = 0;             ///< frame sequences that do not continue the last
    std::uint64_t missing_frames = 0;   ///< by frame sequence; multiples of its modulus go unnoticed
    std::uint64_t repeated_frames = 0;  ///< received before, and dropped
    std::uint64_t late_frames = 0;      ///< received after later ones; no longer missing
    std::uint64_t restarts = 0;         ///< the sequence began anew
    std::uint64_t cut_frames = 0;       ///< the stream ended within it
    std::uint64_t slips = 0;            ///< good frames at another bit, or inverted, than the one before
    // Not in the archive.
    std::uint64_t other_data_frames = 0;  ///< of `frames`: whose data are not packets, as they say
    std::uint64_t corrected_headers = 0;  ///< of `frames`: by the header's error control
    // By a Reed–Solomon code.
    std::uint64_t corrected_frames = 0;      ///< of `frames`: with symbols that were corrected
    std::uint64_t corrected_symbols = 0;     ///< in those
    std::uint64_t uncorrectable_frames = 0;  ///< not read: too many symbols are wrong

    /// Channels given up because more were heard than are followed; the count of each begins anew.
    std::uint64_t forgotten_channels = 0;

    /// Adds the counters of a sequence of frames.
    LinkCounters& operator+=(const SequenceCounters& frames);
    LinkCounters& operator+=(const LinkCounters& other);
    bool operator==(const LinkCounters&) const = default;
};

/// A rate per second, over the last ten whole seconds.
class RateMeter {
  public:
    static constexpr std::int64_t seconds = 10;

    /// Adds `amount` at `at`; an older time than the latest counts as the latest.
    void add(Ert at, std::uint64_t amount);
    /// Mean over the ten whole seconds before the present one.
    double per_second(Ert now) const;

  private:
    static constexpr std::size_t places = seconds + 1;
    std::array<std::uint64_t, places> amounts_{};
    std::int64_t newest_s_ = 0;
};

}  // namespace aeolis::telemetry
