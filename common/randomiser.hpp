// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

namespace aeolis {

/// Adds the pseudo-random sequence of 255 bits, from its beginning, to each bit; a second time takes it away again.
/// Telemetry frames, without the attached sync marker: FF480EC09A0D70BC … [ccsds-131.0-b-5]
void randomise_tm(std::span<std::uint8_t> octets);
/// Telecommand frames with their fill, before they are coded: FF399E5A68 … [ccsds-231.0-b-4]
void randomise_tc(std::span<std::uint8_t> octets);

}  // namespace aeolis
