// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/xtce/packets.hpp"

#include <vector>

namespace aeolis::dictionary::xtce {

/// Reads the concrete MetaCommands: opcode, arguments, preconditions and verifiers.
std::vector<Command> read_commands(const Symbols& symbols, const Types& types, const Parameters& parameters,
                                   const Packets& packets, Reporter& report);

}  // namespace aeolis::dictionary::xtce
