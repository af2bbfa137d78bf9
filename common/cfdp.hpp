// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_vector.hpp"
#include "common/parsed.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <variant>

/// Protocol data units (PDUs) of CFDP class 2, for file delivery over lossy links. [ccsds-727.0-b-5]
///
///   header: version 3 (001) | file data 1 | toward sender 1 | unacknowledged 1 | CRC 1 | large file 1 |
///           octets after the header, with the CRC 16 | segmentation control 1 | octets of an entity id less one 3 |
///           segment metadata 1 | octets of a sequence number less one 3 | source | sequence number | destination
///   then file data: offset 32 | octets;  or a directive: code 8 | its parameters;  then a CRC-16 when the flag is set
/// Read: ids of 1 … 8 octets, and also the version bits 000 used before B-5. Written: entity ids of 2 octets, sequence
/// numbers of 4, version 001. Not read: large files (64-bit offsets), segment metadata.
namespace aeolis::cfdp {

inline constexpr std::size_t written_header_octets = 12;
inline constexpr std::size_t nak_requests_max = 64;  ///< per PDU, chosen; further requests go into the next PDU
/// The rover delivers its recording as files; the name of the last one ends so. Chosen.
inline constexpr std::string_view last_file_ending = ".last";

struct Header {
    bool toward_sender = false;
    bool unacknowledged = false;  ///< class 1
    bool crc = false;
    std::uint64_t source = 0;
    std::uint64_t sequence = 0;
    std::uint64_t destination = 0;

    constexpr bool operator==(const Header&) const = default;
};

enum class Directive : std::uint8_t {
    eof = 4,
    finished = 5,
    ack = 6,
    metadata = 7,
    nak = 8,
    prompt = 9,
    keep_alive = 12
};

enum class Condition : std::uint8_t {
    no_error = 0,
    ack_limit_reached = 1,
    keep_alive_limit_reached = 2,
    invalid_transmission_mode = 3,
    filestore_rejection = 4,
    file_checksum_failure = 5,
    file_size_error = 6,
    nak_limit_reached = 7,
    inactivity_detected = 8,
    invalid_file_structure = 9,
    check_limit_reached = 10,
    unsupported_checksum_type = 11,
    suspend_received = 14,
    cancel_received = 15,
};

enum class Checksum : std::uint8_t { modular = 0, null = 15 };

struct FileData {
    std::uint32_t offset = 0;
    std::span<const std::uint8_t> octets;
};
struct Metadata {
    bool closure_requested = false;
    Checksum checksum = Checksum::modular;
    std::uint32_t file_octets = 0;
    std::string_view source_name{};       ///< at most 255 octets, any content
    std::string_view destination_name{};  ///< likewise
};
struct Eof {
    Condition condition = Condition::no_error;
    std::uint32_t checksum = 0;
    std::uint32_t file_octets = 0;
};
struct Finished {
    Condition condition = Condition::no_error;
    bool complete = true;
    std::uint8_t file_status = 2;  ///< 0 discarded, 1 rejected by the filestore, 2 retained, 3 not reported
};
struct Ack {
    Directive of = Directive::eof;  ///< eof or finished
    Condition condition = Condition::no_error;
    std::uint8_t transaction_status = 1;  ///< 0 undefined, 1 active, 2 terminated, 3 unrecognised
};
/// Octets from `start` up to but not including `end`; {0, 0} requests the metadata.
struct Range {
    std::uint32_t start = 0;
    std::uint32_t end = 0;
    constexpr bool operator==(const Range&) const = default;
    constexpr std::uint32_t octets() const { return end - start; }
};
struct Nak {
    Range scope;
    FixedVector<Range, nak_requests_max> requests;  ///< a NAK read with more than fits keeps its first requests
};
struct Prompt {
    bool keep_alive = false;  ///< true: asks for a keep-alive; false: asks for a NAK
};
struct KeepAlive {
    std::uint32_t progress_octets = 0;
};

using Content = std::variant<FileData, Metadata, Eof, Finished, Ack, Nak, Prompt, KeepAlive>;

struct Pdu {
    Header header;
    Content content;
};

/// Parses one whole PDU; spans and names in it point into `octets`.
/// Fails with too_short, too_long, other_version or bad_checksum; with bad_field for a directive, condition or flag
/// that is not read here.
Parsed<Pdu> read(std::span<const std::uint8_t> octets);

/// Number of octets that write() produces for `pdu`.
std::size_t octets_of(const Pdu& pdu);
/// Writes the PDU and returns the number of octets written. `into` must have room for octets_of(pdu).
std::size_t write(const Pdu& pdu, std::span<std::uint8_t> into);

/// Contribution of `octets`, at `offset` in the file, to the file's modular checksum.
/// The checksum is the sum, modulo 2^32, of the file's 32-bit words, each beginning at a multiple of four and the last
/// padded with zeros. The contributions of parts that cover the file exactly once add up to it, in any order.
std::uint32_t modular_checksum(std::uint32_t offset, std::span<const std::uint8_t> octets);

}  // namespace aeolis::cfdp
