// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <vector>

namespace aeolis::dictionary {

/// The enumerated types of packets and commands, each once, in order of first use.
std::vector<const Type*> enumerations_of(const std::vector<Packet>& packets, const std::vector<Command>& commands);

}  // namespace aeolis::dictionary
