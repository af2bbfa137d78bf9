// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

namespace aeolis {

/// Adds the 255-bit pseudo-random sequence, from its beginning, to each bit; a second call removes it.
/// For telemetry frames, without the attached sync marker: FF480EC09A0D70BC … [ccsds-131.0-b-5]
void randomise_tm(std::span<std::uint8_t> octets);
/// The same for telecommand frames with their fill, before coding: FF399E5A68 … [ccsds-231.0-b-4]
void randomise_tc(std::span<std::uint8_t> octets);

}  // namespace aeolis
