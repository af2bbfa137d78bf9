// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "dictionaries/dictionary.hpp"

#include <cstdint>
#include <string>

// Numbers as they stand in a packet, and as text.
namespace aeolis::commands {

/// The fewest digits that give the same double: "405", "-4.49", "1e+20".
std::string shortest_text(double value);

std::string text_of(Sclk time);  ///< to a millisecond: "397501022.156"

/// The number in a field's bits, `word`, before calibration.
double number_of(const dictionary::Type& type, std::uint64_t word);

}  // namespace aeolis::commands
