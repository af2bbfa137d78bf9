// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/parsed.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace aeolis {

/// Telecommand transfer frame, and the CLCW with the vehicle's report on it. [ccsds-232.0-b-4]
///
///   header 40 bits: version 2 (00) | bypass 1 | control 1 | spare 2 | spacecraft 10 | virtual channel 6 |
///                   octets of the frame less one 10 | frame sequence 8;   data | CRC-16 over all that precedes it
inline constexpr std::size_t tc_frame_header_octets = 5;
inline constexpr std::size_t tc_frame_crc_octets = 2;
inline constexpr std::size_t tc_frame_overhead_octets = tc_frame_header_octets + tc_frame_crc_octets;
inline constexpr std::size_t tc_frame_octets_max = 1024;
inline constexpr std::size_t tc_frame_data_octets_max = tc_frame_octets_max - tc_frame_overhead_octets;

struct TcFrameHeader {
    bool bypass = false;               ///< true: type B, accepted in any sequence; false: type A, in sequence only
    bool control = false;              ///< the data field is a control command to FARM-1, not data
    std::uint16_t spacecraft = 0;      ///< 10 bits
    std::uint8_t virtual_channel = 0;  ///< 6 bits
    std::uint8_t sequence = 0;         ///< N(S)

    constexpr bool operator==(const TcFrameHeader&) const = default;
};

struct TcFrame {
    TcFrameHeader header;
    std::span<const std::uint8_t> data;
};

/// Parses the frame that begins `octets`; octets after it, such as the fill of a CLTU, are ignored.
Parsed<TcFrame> read_tc_frame(std::span<const std::uint8_t> octets);

/// Writes the frame and returns the number of octets written.
/// `data`: 1 … 1017 octets. `into` must have room.
std::size_t write_tc_frame(const TcFrameHeader& header, std::span<const std::uint8_t> data,
                           std::span<std::uint8_t> into);

/// Communications link control word: the state of FARM-1 for one virtual channel. 32 bits:
///   type 1 (0) | version 2 (00) | status 3 | COP 2 (01) | virtual channel 6 | spare 2 | no RF 1 | no bit lock 1 |
///   lockout 1 | wait 1 | retransmit 1 | FARM-B counter 2 | spare 1 | N(R) 8
struct Clcw {
    std::uint8_t cop = 1;
    std::uint8_t virtual_channel = 0;
    bool no_rf = false;
    bool no_bit_lock = false;
    bool lockout = false;
    bool wait = false;
    bool retransmit = false;
    std::uint8_t farm_b = 0;    ///< frames accepted by bypass, modulo 4
    std::uint8_t expected = 0;  ///< N(R): the next sequence number expected

    constexpr bool operator==(const Clcw&) const = default;
};
inline constexpr std::size_t clcw_octets = 4;

/// Parses four octets. Fails with other_version; bad_field when the type is not that of a CLCW.
Parsed<Clcw> read_clcw(std::span<const std::uint8_t> octets);
/// The CLCW as a 32-bit number.
std::uint32_t word_of(const Clcw& clcw);
void write_clcw(const Clcw& clcw, std::span<std::uint8_t, clcw_octets> into);

}  // namespace aeolis
