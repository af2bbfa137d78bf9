// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <string>

namespace aeolis::dictionary::autocoder {

/// generated/timeline.cpp: the tables that the timeline and the tone selector interpret.
/// Actions and events appear as C++ names, each row under a #line of the spreadsheet, so that the compiler checks them
/// and names the row. R20, R40
std::string timeline_source(const Dictionary& dictionary);

}  // namespace aeolis::dictionary::autocoder
