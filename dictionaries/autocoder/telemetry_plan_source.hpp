// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <string>

namespace aeolis::dictionary::autocoder {

/// generated/telemetry_plan.cpp: the rows that EdlComm interprets.
/// Plans, packets and priorities appear as C++ names, each row under a #line of the spreadsheet, so that the compiler
/// checks them and names the row. R30, R40
std::string telemetry_plan_source(const Dictionary& dictionary);

}  // namespace aeolis::dictionary::autocoder
