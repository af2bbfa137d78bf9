// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/parsed.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace aeolis {

/// TM and AOS transfer frames of fixed length, as other missions send them to their stations.
///
///   TM   48 bits: version 2 (00) | spacecraft 10 | virtual channel 3 | control field 1 | master count 8 |
///        virtual count 8 | secondary header 1 | synchronised 1 | packet order 1 | segment length 2 | pointer 11
///   AOS  48 bits: version 2 (01) | spacecraft 8 | virtual channel 6 | count 24 | replay 1 | cycle used 1 | spare 2 |
///        cycle 4;   then spare 5 | pointer 11
///   data | operational control field 4, if present | CRC-16 over all that precedes it, if present
/// [ccsds-132.0-b-3] [ccsds-732.0-b-4]
inline constexpr std::array<std::uint8_t, 4> attached_sync_marker{0x1A, 0xCF, 0xFC, 0x1D};  ///< [ccsds-131.0-b-5]
inline constexpr std::uint16_t no_packet_begins = 0x7FF;
inline constexpr std::uint16_t only_idle_data = 0x7FE;
inline constexpr std::size_t transfer_frame_octets_max = 65536;  ///< chosen; the longest in use are a few thousand

/// Properties of a mission's frames that the frames themselves do not declare.
struct FrameAgreement {
    bool crc = true;                    ///< frames end with a CRC-16
    bool control_field = false;         ///< AOS only: a TM frame declares it
    bool header_error_control = false;  ///< AOS only: 2 octets at the end of the header, by which it is corrected
    std::uint8_t insert_octets = 0;     ///< AOS only: insert zone after the header
};

struct TransferFrame {
    std::uint16_t spacecraft = 0;
    std::uint8_t virtual_channel = 0;
    std::uint32_t count = 0;            ///< count of the virtual channel
    std::uint32_t count_modulus = 256;  ///< 2^8 for TM, 2^24 for AOS
    bool replay = false;
    unsigned corrected_symbols = 0;  ///< of the header, by its error control
    bool packets = true;             ///< in `data`; false: other data, as a TM frame's synchronisation flag says
    std::uint16_t first_header_pointer = no_packet_begins;  ///< offset in `data` of the first packet that begins there
    std::span<const std::uint8_t> data;
    std::optional<std::uint32_t> control_field;  ///< usually a CLCW
};

/// Parse a whole frame.
/// Fail with bad_field when a field leaves no room for data, or the header's error control finds more wrong than it
/// corrects.
Parsed<TransferFrame> read_tm_frame(std::span<const std::uint8_t> frame, const FrameAgreement& agreed);
Parsed<TransferFrame> read_aos_frame(std::span<const std::uint8_t> frame, const FrameAgreement& agreed);

/// Write a whole frame, without secondary header and insert zone.
/// Taken from `frame`: data, pointer, counts and control field. `into` must be exactly as long as the frame.
void write_tm_frame(const TransferFrame& frame, std::uint8_t master_count, bool crc, std::span<std::uint8_t> into);
void write_aos_frame(const TransferFrame& frame, bool crc, std::span<std::uint8_t> into);

}  // namespace aeolis
