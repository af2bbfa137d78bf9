// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace aeolis::telemetry {

/// How a stream of bits lies in its octets: units begin `shift` bits, 0 … 7, behind the beginning of an octet, and all
/// bits may be inverted, as a receiver leaves them that does not know the phase of its carrier.
struct BitAlignment {
    unsigned shift = 0;
    bool inverted = false;
    bool operator==(const BitAlignment&) const = default;
};

/// Octets `first` … `first + size` of a stream as they were sent; with a shift one more of them is read.
void align(std::span<const std::uint8_t> octets, std::size_t first, std::size_t size, const BitAlignment& alignment,
           std::vector<std::uint8_t>& into);

/// Number of wrong bits in the attached sync marker that should stand at `octets`; 32 when there are too few octets.
unsigned marker_errors(std::span<const std::uint8_t> octets, const BitAlignment& alignment);

/// An attached sync marker without wrong bits.
struct MarkerFound {
    std::size_t octet = 0;  ///< in which it begins
    BitAlignment alignment;
};
/// The first marker at any bit, inverted or not, that begins at octet `from` or later. Those that octets to come can
/// complete are not found: they begin in the last four octets.
std::optional<MarkerFound> find_marker(std::span<const std::uint8_t> octets, std::size_t from);

}  // namespace aeolis::telemetry
