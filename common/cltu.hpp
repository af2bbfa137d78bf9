// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/parsed.hpp"
#include "common/tc_frame.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace aeolis {

/// Communications link transmission unit (CLTU) for telecommand frames on the uplink. [ccsds-231.0-b-4]
///
///   EB90 | code blocks | C5C5C5C5C5C5C579
///   code block 8 octets: 56 bits of information | their 7 bits of BCH parity, inverted | 0
/// The information is padded with 55 to whole blocks. Parity detects every error of one or two bits in a block; no bit
/// is corrected.
inline constexpr std::size_t cltu_block_information_octets = 7;
inline constexpr std::size_t cltu_block_octets = 8;

constexpr std::size_t cltu_blocks(std::size_t information_octets) {
    return (information_octets + cltu_block_information_octets - 1) / cltu_block_information_octets;
}
/// Octets of the CLTU that carries `information_octets` of information.
constexpr std::size_t cltu_octets(std::size_t information_octets) {
    return 2 + cltu_blocks(information_octets) * cltu_block_octets + 8;
}
inline constexpr std::size_t cltu_octets_max = cltu_octets(tc_frame_octets_max);
/// Octets of information in the largest CLTU, including its fill.
inline constexpr std::size_t cltu_information_octets_max =
    cltu_blocks(tc_frame_octets_max) * cltu_block_information_octets;

/// The last octet of the code block that holds these 7 octets of information.
std::uint8_t bch_parity_octet(std::span<const std::uint8_t, cltu_block_information_octets> information);

/// Writes the CLTU and returns the number of octets written.
/// `into` must have room for cltu_octets(information.size()).
std::size_t write_cltu(std::span<const std::uint8_t> information, std::span<std::uint8_t> into);

/// Extracts the information of a CLTU into `into` and returns its number of octets, including the fill.
/// As the standard requires, the first block with wrong parity ends the CLTU; the tail sequence is such a block. The
/// CRC of the frame inside tells whether the frame is whole. Fails with no_start; too_short when the octets end before
/// a block with wrong parity; bad_checksum when the first block is one; too_long when `into` is full.
Parsed<std::size_t> read_cltu(std::span<const std::uint8_t> cltu, std::span<std::uint8_t> into);

}  // namespace aeolis
