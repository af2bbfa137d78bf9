// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ephemeris.hpp"
#include "common/result.hpp"

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace aeolis {

/// Bodies and frames by SPICE's numbers.
inline constexpr std::int32_t spice_mars = 499, spice_msl = -76, spice_j2000 = 1, spice_iau_mars = 10014;

/// A segment of a trajectory kernel: a body's states relative to another, in a frame. [naif-spk]
struct SpkSegment {
    std::string name;
    std::int32_t body = 0, centre = 0, frame = spice_j2000, type = 13;
    Ephemeris ephemeris;  ///< of the types 9 (Lagrange) and 13 (Hermite); empty of the others, which are not read
};

/// Reads all segments. Fails when the file is no SPK, or a segment of type 9 or 13 contradicts itself.
Result<std::vector<SpkSegment>> read_spk(std::span<const std::uint8_t> file);

/// Writes segments of type 9 or 13 as their ephemeris interpolates. Each has as many states as its polynomial takes.
Result<std::vector<std::uint8_t>> write_spk(const std::vector<SpkSegment>& segments, std::string_view program);

}  // namespace aeolis
