// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

namespace aeolis {

/// CRC-16 of our packets and TC frames: polynomial 1021, start FFFF, not reflected. [ccsds-232.0-b-4]
/// To continue over several spans, pass the CRC of the preceding octets as `start`.
std::uint16_t crc16(std::span<const std::uint8_t> octets, std::uint16_t start = 0xFFFF);

/// CRC-32 of Proximity-1: polynomial 00A00805, start 0, not reflected, no final xor. [ccsds-211.2-b-3]
std::uint32_t crc32_proximity(std::span<const std::uint8_t> octets);

}  // namespace aeolis
