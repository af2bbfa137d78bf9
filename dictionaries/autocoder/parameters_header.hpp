// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <string>

namespace aeolis::dictionary::autocoder {

/// generated/parameters.hpp: what ground may change as members of Parameters, what is fixed as constants, and the table
/// of all by id with their ranges. R25, R48
std::string parameters_header(const Dictionary& dictionary);

}  // namespace aeolis::dictionary::autocoder
