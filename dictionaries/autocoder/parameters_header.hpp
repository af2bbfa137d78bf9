// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <string>

namespace aeolis::dictionary::autocoder {

/// generated/parameters.hpp: members of Parameters for what ground may change, constants for what is fixed, and the
/// table of all parameters by id with their ranges. R25, R48
std::string parameters_header(const Dictionary& dictionary);

/// generated/parameter_names.hpp, for ground: the names of all parameters, by id.
std::string parameter_names_header(const Dictionary& dictionary);

}  // namespace aeolis::dictionary::autocoder
