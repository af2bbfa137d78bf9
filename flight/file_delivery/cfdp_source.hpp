// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/cfdp.hpp"
#include "common/fixed_vector.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace aeolis::flight {

/// Sends one file by CFDP class 2, which guarantees complete delivery. [ccsds-727.0-b-5]
///
/// In      PDUs from the receiver (any); repeat() when an answer is overdue; the file's octets at each call of next(),
///         always the same
/// Out     PDUs, one by one, as long as there is something to send: requested retransmissions first
/// Memory  this object: 512 ranges to be retransmitted. Further requests are dropped: the receiver asks again
/// Faults  PDUs of other transactions, or that a sender does not expect, change nothing. After a restart of the
///         computer, a new source with the same sequence number, or an older copy, can continue: the receiver drops
///         duplicates
class CfdpSource {
  public:
    static constexpr std::size_t ranges_max = 512;
    static constexpr std::size_t name_octets_max = 64;  ///< chosen
    static constexpr std::uint16_t segment_octets_usual = 900;

    struct File {
        std::uint16_t source = 0;  ///< entity ids
        std::uint16_t destination = 0;
        std::uint32_t sequence = 0;  ///< transaction sequence number
        std::uint32_t octets = 0;
        std::uint16_t segment_octets = segment_octets_usual;  ///< file data in one PDU
    };
    /// `name` is the file's name at both ends.
    CfdpSource(const File& file, std::string_view name);

    void on(const cfdp::Pdu& pdu);

    /// Writes the next PDU and returns its octets; 0: nothing to send. `into` must hold pdu_octets_max().
    std::size_t next(std::span<const std::uint8_t> file, std::span<std::uint8_t> into);

    /// Announces the end of the file again, because no answer arrived in the expected time.
    void repeat();

    bool done() const { return finished_ && !finished_ack_due_; }  ///< the receiver has reported how the transfer ended
    bool delivered() const { return delivered_; }                  ///< the receiver has the whole file
    std::uint32_t sent_octets() const { return sent_octets_; }     ///< of the file, each octet counted once
    std::uint32_t to_repeat_octets() const;

    /// Octets of the largest PDU of this file.
    std::size_t pdu_octets_max() const;

  private:
    std::size_t put(const cfdp::Content& content, std::span<std::uint8_t> into) const;
    std::size_t put_repeated(std::span<const std::uint8_t> file, std::span<std::uint8_t> into);
    std::size_t put_first_time(std::span<const std::uint8_t> file, std::span<std::uint8_t> into);
    void send_again(const cfdp::Range& asked);

    File file_;
    FixedVector<char, name_octets_max> name_;
    FixedVector<cfdp::Range, ranges_max> again_;
    std::uint32_t sent_octets_ = 0;
    std::uint32_t checksum_ = 0;  ///< of octets sent for the first time
    bool metadata_due_ = true;
    bool eof_due_ = true;
    bool eof_acknowledged_ = false;
    bool finished_ = false;
    bool finished_ack_due_ = false;
    bool delivered_ = false;
};

}  // namespace aeolis::flight
