// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/file_delivery/cfdp_source.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace aeolis::flight {

/// Delivers the recording to ground after landing, as files numbered from 1 in the order of recording.
///
/// Each file is one CFDP class 2 transaction. Runs on the rover's relay radio after EDL.
///
/// In      the recording, which only grows; forward PLTUs from ground (any octets); repeat() when answers are overdue
/// Out     PLTUs, one by one; requested retransmissions go before new data
/// Files   whole packets: at least `file_octets`, rounded up to the end of a packet. Once the recording is closed, the
///         rest is the last file, and its name says so; it is empty when nothing is left
/// Memory  this object: `open_max` transactions; the next file waits until one of them has ended
/// Faults  unreadable input, or input for another file, changes nothing. After a restart, a new object begins again
///         with the first file: ground drops duplicates, and reports each file that it already has. A file that ground
///         could not accept is sent once more from its beginning
class RecordingDelivery {
  public:
    static constexpr std::uint32_t file_octets = 262144;  ///< chosen: 1 s at 2 Mb/s
    static constexpr std::size_t open_max = 32;  ///< chosen: 8 MiB in flight, while answers take two light times

    struct Recording {
        std::span<const std::uint8_t> octets;  ///< whole packets, one after another
        bool closed = false;                   ///< nothing more will be recorded
    };

    /// Handles a PLTU that holds a packet with a PDU from the receiver.
    void on(std::span<const std::uint8_t> pltu);

    /// Writes the next PLTU and returns its octets; 0: nothing to send. `into` must hold the largest PLTU.
    std::size_t next(const Recording& recording, std::span<std::uint8_t> into);

    /// Announces the ends of the open files again, because answers are overdue.
    void repeat();

    bool waits_for_answers() const;
    /// Whether the whole recording was sent and ground has reported the end of every file.
    bool done(const Recording& recording) const { return recording.closed && last_begun_ && !any_open(); }

  private:
    struct OpenFile {
        std::uint32_t number = 0, start = 0, octets = 0;
        bool last = false;
        CfdpSource source;
    };

    bool any_open() const;
    static CfdpSource source_of(std::uint32_t number, std::uint32_t octets, bool last);
    std::size_t next_of_open(const Recording& recording, std::span<std::uint8_t> pdu);
    std::size_t next_acknowledgement(std::span<std::uint8_t> pdu);
    bool begin_next(const Recording& recording);
    std::size_t wrapped(std::span<const std::uint8_t> pdu, std::span<std::uint8_t> into);

    std::array<std::optional<OpenFile>, open_max> open_;
    FixedVector<std::uint32_t, open_max>
        ends_to_acknowledge_;  ///< of closed files: ground has not received the acknowledgement
    std::uint32_t files_ = 0;
    bool last_begun_ = false;
    std::uint32_t next_start_ = 0;
    std::uint32_t scanned_ = 0;  ///< end of the packets assigned to the next file so far
    std::uint16_t packet_count_ = 0;
    std::uint8_t frame_sequence_ = 0;
};

}  // namespace aeolis::flight
