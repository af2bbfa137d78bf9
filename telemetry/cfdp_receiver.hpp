// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/cfdp.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace aeolis::telemetry {

/// The state of one file's reception, in plain values.
///
/// Stored with the file's octets in one transaction, it lets either end restart at any time.
struct Reception {
    enum class Outcome : std::uint8_t {
        under_way,
        complete,
        wrong_checksum,  ///< all octets received, but their checksum is not the sender's
        wrong_size,      ///< the sender states fewer octets than were received
        cancelled,       ///< by the sender
    };

    std::uint64_t source = 0;  ///< with `sequence`, identifies the transaction
    std::uint64_t sequence = 0;
    std::uint64_t destination = 0;
    std::optional<std::uint32_t> file_octets;  ///< from the metadata
    std::string source_name, destination_name;
    std::optional<cfdp::Eof> eof;
    std::vector<cfdp::Range> received;  ///< sorted; no two touch
    std::uint32_t checksum = 0;         ///< of the octets received
    Outcome outcome = Outcome::under_way;
    bool outcome_acknowledged = false;  ///< the sender knows it
};

/// The state of a transaction that this PDU begins. None when it comes from a receiver, is of class 1, or its ids are
/// longer than ours.
std::optional<Reception> reception_of(const cfdp::Header& header);

/// The number of octets received, each counted once.
std::uint64_t received_octets(const Reception& reception);

/// Receives one file by CFDP class 2. [ccsds-727.0-b-5]
///
/// In       PDUs of one transaction, in any order and number; ask() at the beginning of a pass, or when an answer is
///          overdue
/// Out      octets to write, never twice; PDUs to send back
/// Memory   one range for each separate piece, at most `ranges_max`; data that would need more are dropped and
///          requested again
/// Faults   PDUs of other transactions, and contradictions, are counted and change nothing
class CfdpReceiver {
  public:
    static constexpr std::size_t ranges_max = 65536;                   ///< chosen
    static constexpr std::uint32_t file_octets_max = 1024U * 1048576;  ///< chosen: space on disk for one file
    static constexpr std::size_t naks_at_once_max = 8;                 ///< chosen: as many as our sender keeps

    struct Write {
        std::uint32_t offset = 0;
        std::span<const std::uint8_t> octets;  ///< of the PDU
    };

    /// Continues a stored transaction, or begins a new one.
    explicit CfdpReceiver(Reception kept) : state_(std::move(kept)) {}

    /// Takes a PDU. Returns the octets to write to the file; store `state()` with them.
    std::vector<Write> on(const cfdp::Pdu& pdu);

    /// The next PDU to the file's sender.
    std::optional<std::vector<std::uint8_t>> next();

    /// Requests what is still missing, or repeats the outcome.
    void ask();

    const Reception& state() const { return state_; }
    std::uint64_t refused() const { return refused_; }  ///< PDUs of other transactions, and contradictions

  private:
    std::vector<Write> take(const cfdp::FileData& data);
    void take(const cfdp::Metadata& metadata);
    void take(const cfdp::Eof& eof);
    void say_again();
    bool insert(const cfdp::Range& range);
    void conclude();
    void end(Reception::Outcome outcome);
    std::vector<std::uint8_t> written(const cfdp::Content& content) const;

    Reception state_;
    std::vector<cfdp::Nak> naks_;
    bool eof_ack_due_ = false;
    bool finished_due_ = false;
    std::uint64_t refused_ = 0;
};

}  // namespace aeolis::telemetry
