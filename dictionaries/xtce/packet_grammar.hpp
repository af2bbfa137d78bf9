// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/xtce/document.hpp"

namespace aeolis::dictionary::xtce {

/// Reports what stands in the types, parameters and containers of any mission's telemetry and is not read: each element
/// and attribute that XTCE 1.0 to 1.3 does not have at its place, and of those that it has the ones that would change a
/// value, a packet or an alarm. What only describes (names in other places, descriptions, texts for people) is passed
/// over. [xtce-1.2] and the schemas of 1.0, 1.1 and 1.3
void check_grammar(const Document& document, Reporter& report);

}  // namespace aeolis::dictionary::xtce
