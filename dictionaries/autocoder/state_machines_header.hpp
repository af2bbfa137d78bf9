// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <string>

namespace aeolis::dictionary::autocoder {

/// generated/state_machines.hpp: the tables by which flight's state machines change their states, and the enumerations
/// of their events. States stand in it as the C++ labels of the XTCE's enumerations, each row under a #line of
/// state_machines.csv. R40, R48
std::string state_machines_header(const Dictionary& dictionary);

}  // namespace aeolis::dictionary::autocoder
