// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/parsed.hpp"
#include "common/tc_frame.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace aeolis {

/// The unit (CLTU) that carries telecommand frames over the uplink. [ccsds-231.0-b-4]
///
///   EB90 | code blocks | C5C5C5C5C5C5C579
///   code block 8 octets: 56 bits of information | their 7 bits of BCH parity, inverted | 0
/// The information is filled up to whole blocks with 55. Parity finds every error of one or two bits in a block; no
/// bit is corrected.
inline constexpr std::size_t cltu_block_information_octets = 7;
inline constexpr std::size_t cltu_block_octets = 8;

constexpr std::size_t cltu_blocks(std::size_t information_octets) {
    return (information_octets + cltu_block_information_octets - 1) / cltu_block_information_octets;
}
/// Of the CLTU that carries so many octets of information.
constexpr std::size_t cltu_octets(std::size_t information_octets) {
    return 2 + cltu_blocks(information_octets) * cltu_block_octets + 8;
}
inline constexpr std::size_t cltu_octets_max = cltu_octets(tc_frame_octets_max);
/// Room for what the largest CLTU carries, with its fill.
inline constexpr std::size_t cltu_information_octets_max =
    cltu_blocks(tc_frame_octets_max) * cltu_block_information_octets;

/// The last octet of the code block with these 7 octets of information.
std::uint8_t bch_parity_octet(std::span<const std::uint8_t, cltu_block_information_octets> information);

/// Writes the CLTU and returns its octets. `into` has room for cltu_octets(information.size()).
std::size_t write_cltu(std::span<const std::uint8_t> information, std::span<std::uint8_t> into);

/// Takes a CLTU apart into `into` and returns the octets of information, fill included. As the standard has it, the
/// first block whose parity is wrong ends the unit, as the tail's does: whether a frame is whole says its own CRC.
/// no_start; too_short when the octets end before such a block; bad_checksum when it is the first; too_long when
/// `into` is full.
Parsed<std::size_t> read_cltu(std::span<const std::uint8_t> cltu, std::span<std::uint8_t> into);

}  // namespace aeolis
