// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/xtce/packet_model.hpp"

#include <cstdint>
#include <optional>
#include <variant>

namespace aeolis::telemetry {

using RawNumber = std::variant<std::uint64_t, std::int64_t, double>;

/// Reads a number from `bits` (1 … 64) bits of a coding, most significant bit first. NaN when the bits are not a
/// number, such as a decimal digit above 9.
///
/// Source: [xtce-1.2]; [mil-std-1750a] for its real number of 24 bits mantissa and 8 bits exponent, both two's
/// complement
RawNumber number_in(std::uint64_t field, unsigned bits, const dictionary::xtce::Coding& coding);

/// The calibrated value; none where it is undefined: outside a spline's points, or not finite.
std::optional<double> calibrated_by(const dictionary::xtce::Calibration& calibration, double raw);

}  // namespace aeolis::telemetry
