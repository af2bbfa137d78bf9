// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace aeolis::telemetry {

/// How the bits of a stream lie in its octets. Octets as they were sent begin `shift` bits, 0 … 7, behind the beginning
/// of an octet as received. All bits may be inverted, by a receiver that does not know the phase of its carrier.
struct BitAlignment {
    unsigned shift = 0;
    bool inverted = false;
    bool operator==(const BitAlignment&) const = default;
};

/// Writes octets `first` … `first + size` of a stream as they were sent. With a shift, one more octet is read.
void align(std::span<const std::uint8_t> octets, std::size_t first, std::size_t size, const BitAlignment& alignment,
           std::vector<std::uint8_t>& into);

/// Number of wrong bits in the attached sync marker that should stand at `octets`; 32 when there are too few octets.
unsigned marker_errors(std::span<const std::uint8_t> octets, const BitAlignment& alignment);

/// An attached sync marker without wrong bits.
struct MarkerFound {
    std::size_t octet = 0;  ///< in which it begins
    BitAlignment alignment;
};
/// The first marker at any bit, inverted or not, that begins at octet `from` or later. A marker that needs octets still
/// to come is not found; it begins in the last four octets.
std::optional<MarkerFound> find_marker(std::span<const std::uint8_t> octets, std::size_t from);

/// The same of a PLTU's marker FAF320. One that needs octets still to come begins in the last three octets.
std::optional<MarkerFound> find_pltu_marker(std::span<const std::uint8_t> octets, std::size_t from);

}  // namespace aeolis::telemetry
