// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <string>

namespace aeolis::dictionary::autocoder {

/// The state machines as Mermaid diagrams, each under a heading in a fenced block.
/// Generated from the same table as flight's code. R48
std::string state_diagrams(const Dictionary& dictionary);

}  // namespace aeolis::dictionary::autocoder
