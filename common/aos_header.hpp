// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace aeolis {

/// The primary header of an AOS frame with its error control: 48 bits, of which the virtual channel's count is not
/// protected, and 16 bits.
using AosHeader = std::array<std::uint8_t, 8>;

/// Corrects the header by its error control, a Reed–Solomon code (10,6) of symbols of four bits, in GF(16) by x⁴ + x +
/// 1, with the generator (x + α⁶)(x + α⁷)(x + α⁸)(x + α⁹): up to two wrong symbols.
/// @return  the number of symbols corrected; none: more are wrong, and the header is as it was. Of headers of random
///          bits about one in six is taken for a correctable one
/// Source: [ccsds-732.0-b-4]
std::optional<unsigned> correct_aos_header(AosHeader& header);

}  // namespace aeolis
