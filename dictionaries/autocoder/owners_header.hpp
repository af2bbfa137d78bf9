// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <string>

namespace aeolis::dictionary::autocoder {

/// generated/owners.hpp: the module that owns each decision, device and action.
/// Modules appear as enumerators of flight's ModuleId, each row under a #line of owners.csv, so that the compiler
/// checks them. R5, R40
std::string owners_header(const Dictionary& dictionary);

}  // namespace aeolis::dictionary::autocoder
