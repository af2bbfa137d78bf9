// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <string>

namespace aeolis::dictionary::autocoder {

/// The table that flight checks its sub-constraints by, for generated/timeline.cpp: each row under a #line of
/// constraints.csv, its moments as C++ names of timepoints and anchors. R39, R40
std::string constraint_table(const Dictionary& dictionary);

}  // namespace aeolis::dictionary::autocoder
