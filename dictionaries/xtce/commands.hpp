// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/xtce/packets.hpp"

#include <vector>

namespace aeolis::dictionary::xtce {

/// The concrete MetaCommands: opcode, arguments, what must hold before, what shows that a stage was reached.
std::vector<Command> read_commands(const Symbols& symbols, const Types& types, const Parameters& parameters,
                                   const Packets& packets, Reporter& report);

}  // namespace aeolis::dictionary::xtce
