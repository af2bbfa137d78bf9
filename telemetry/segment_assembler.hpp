// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace aeolis::telemetry {

/// Puts together what a sender has divided into several space packets, by their sequence flags. [ccsds-133.0-b-2,
/// 4.1.3.4.2]
///
/// In       space packets of any mission, in order          Out   unsegmented packets as they came; segments as one
///          packet: the first one's header, marked unsegmented, and the data fields of all
/// Memory   apids_max unfinished packets of 65542 octets each at most
/// Faults   counted, and nothing is given out: a count missing or repeated between two segments, a segment without a
///          first one, a first one before the last, more data than a packet can have, a secondary header in a later
///          segment, whose length is not known
class SegmentAssembler {
  public:
    static constexpr std::size_t apids_max = 64;  ///< chosen: unfinished at a time; of more, the least APID is given up

    /// The whole packet, if there is one now; valid until the next call.
    std::optional<std::span<const std::uint8_t>> add(std::span<const std::uint8_t> packet);
    /// Gives up what is unfinished.
    void end();
    std::uint64_t lost_segments() const { return lost_; }

  private:
    struct Begun {
        std::vector<std::uint8_t> octets;
        std::uint64_t segments = 0;
        std::uint16_t count = 0;  ///< of the last segment
    };
    void give_up(std::uint16_t apid);

    std::map<std::uint16_t, Begun> begun_;  ///< by APID
    std::vector<std::uint8_t> whole_;
    std::uint64_t lost_ = 0;
};

}  // namespace aeolis::telemetry
