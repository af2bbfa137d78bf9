// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/file_delivery/cfdp_source.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace aeolis::flight {

/// Brings the recording to ground after landing: as files, each a CFDP transaction of class 2, numbered from 1 in the
/// order in which they were recorded. Runs on the rover's relay radio, when EDL is over.
///
/// In      the recording, which only grows; forward PLTUs from ground (any octets); repeat() when answers are overdue
/// Out     PLTUs, one by one: what ground asks for again goes before what it has not had
/// Files   whole packets, `file_octets` and what completes the last; the last file when the recording is closed
/// Memory  this object: `open_max` transactions; the next file waits until one of them has ended
/// Faults  what cannot be read, or is for another file, changes nothing. Made anew after a restart it begins with the
///         first file again: ground takes no octet twice, and says of each file that it has it. A file that ground
///         could not take is sent once more from its beginning
class RecordingDelivery {
  public:
    static constexpr std::uint32_t file_octets = 262144;  ///< ours: 1 s at 2 Mb/s
    static constexpr std::size_t open_max = 32;  ///< ours: 8 MiB on their way, for answers that take two light times

    struct Recording {
        std::span<const std::uint8_t> octets;  ///< whole packets, one after another
        bool closed = false;                   ///< nothing more will be recorded
    };

    /// A PLTU with a packet with a PDU from the receiver.
    void on(std::span<const std::uint8_t> pltu);

    /// Writes the next PLTU into `into`, which has room for the largest, and returns its octets; 0: nothing to send.
    std::size_t next(const Recording& recording, std::span<std::uint8_t> into);

    /// Answers have not come in the time that they take: the ends of the files on their way are announced again.
    void repeat();

    bool waits_for_answers() const;
    /// The whole recording was sent, and ground has said of every file how it ended.
    bool done(const Recording& recording) const {
        return recording.closed && next_start_ == recording.octets.size() && !any_open();
    }

  private:
    struct OpenFile {
        std::uint32_t number = 0, start = 0, octets = 0;
        CfdpSource source;
    };

    bool any_open() const;
    static CfdpSource source_of(std::uint32_t number, std::uint32_t octets);
    std::size_t next_of_open(const Recording& recording, std::span<std::uint8_t> pdu);
    std::size_t next_acknowledgement(std::span<std::uint8_t> pdu);
    bool begin_next(const Recording& recording);
    std::size_t wrapped(std::span<const std::uint8_t> pdu, std::span<std::uint8_t> into);

    std::array<std::optional<OpenFile>, open_max> open_;
    FixedVector<std::uint32_t, open_max>
        ends_to_acknowledge_;  ///< of files that are no longer open: ground has not heard it
    std::uint32_t files_ = 0;
    std::uint32_t next_start_ = 0;
    std::uint32_t scanned_ = 0;  ///< end of the packets that the next file will have, so far
    std::uint16_t packet_count_ = 0;
    std::uint8_t frame_sequence_ = 0;
};

}  // namespace aeolis::flight
