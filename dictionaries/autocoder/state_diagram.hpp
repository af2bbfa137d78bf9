// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <string>

namespace aeolis::dictionary::autocoder {

/// The state machines as diagrams in Mermaid's text, from the same table as flight's code: a heading and a fenced block
/// each. R48
std::string state_diagrams(const Dictionary& dictionary);

}  // namespace aeolis::dictionary::autocoder
