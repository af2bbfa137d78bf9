// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <string>

namespace aeolis::dictionary::autocoder {

/// The table of sub-constraints that flight checks, for generated/timeline.cpp.
/// One row for each row of constraints.csv, under its #line; moments as C++ names of timepoints and anchors. R39, R40
std::string constraint_table(const Dictionary& dictionary);

}  // namespace aeolis::dictionary::autocoder
