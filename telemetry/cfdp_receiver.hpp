// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/cfdp.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace aeolis::telemetry {

/// All that is known of one file on its way: plain values, to be kept with the file's octets in one transaction, so
/// that either end may be restarted at any time.
struct Reception {
    enum class Outcome : std::uint8_t {
        under_way,
        complete,
        wrong_checksum,  ///< all octets came, and are not those that the sender counted
        wrong_size,      ///< the sender says fewer octets than came
        cancelled,       ///< by the sender
    };

    std::uint64_t source = 0;  ///< with `sequence` the name of the transaction
    std::uint64_t sequence = 0;
    std::uint64_t destination = 0;
    std::optional<std::uint32_t> file_octets;  ///< from the metadata
    std::string source_name, destination_name;
    std::optional<cfdp::Eof> eof;
    std::vector<cfdp::Range> received;  ///< sorted; no two touch
    std::uint32_t checksum = 0;         ///< of what was received
    Outcome outcome = Outcome::under_way;
    bool outcome_acknowledged = false;  ///< the sender knows it
};

/// That of a transaction which this PDU begins; none when it comes from a receiver, is of class 1, or has ids longer
/// than those that we write.
std::optional<Reception> reception_of(const cfdp::Header& header);

/// The octets that came, each counted once.
std::uint64_t received_octets(const Reception& reception);

/// Receives one file by CFDP class 2. [ccsds-727.0-b-5]
///
/// In       PDUs of one transaction, in any order and number; ask() at the beginning of a pass, or when what was asked
///          for has not come in the time that it takes
/// Out      octets to write, never twice; PDUs to send back
/// Memory   a range for each piece that stands alone, `ranges_max` of them; what would need more is dropped and asked
///          for again
/// Faults   what does not belong to the transaction or contradicts what is known is counted and changes nothing
class CfdpReceiver {
  public:
    static constexpr std::size_t ranges_max = 65536;                   ///< ours
    static constexpr std::uint32_t file_octets_max = 1024U * 1048576;  ///< ours: what the disk is asked for at most
    static constexpr std::size_t naks_at_once_max = 8;                 ///< ours: as much as our sender keeps

    struct Write {
        std::uint32_t offset = 0;
        std::span<const std::uint8_t> octets;  ///< of the PDU's
    };

    /// A new transaction, or one that was kept.
    explicit CfdpReceiver(Reception kept) : state_(std::move(kept)) {}

    /// What is to be written to the file; then `state()` is to be kept with it.
    std::vector<Write> on(const cfdp::Pdu& pdu);

    /// The next PDU to send to the sender of the file.
    std::optional<std::vector<std::uint8_t>> next();

    /// Asks for what is missing so far, or says again how it ended.
    void ask();

    const Reception& state() const { return state_; }
    std::uint64_t refused() const { return refused_; }  ///< PDUs that do not belong here or contradict what is known

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
