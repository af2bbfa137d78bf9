// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <string>

namespace aeolis::dictionary::autocoder {

/// generated/state_machines.hpp: transition tables and events of flight's state machines.
/// States appear as the C++ labels of XTCE enumerations, each row under a #line of state_machines.csv. R40, R48
std::string state_machines_header(const Dictionary& dictionary);

}  // namespace aeolis::dictionary::autocoder
