// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <string>

namespace aeolis::dictionary::autocoder {

/// generated/dictionary_flight.hpp: flight's part of the dictionary as C++.
/// Holds enumerations, packet and event encoders, command decoders, ids, parameter defaults. It includes the standard
/// library and common/ only. R40, R48
std::string flight_header(const Dictionary& dictionary);

}  // namespace aeolis::dictionary::autocoder
