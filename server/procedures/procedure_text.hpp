// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "server/procedures/procedure.hpp"

#include <string>

namespace aeolis::server::procedures {

inline constexpr std::size_t page_columns = 78;  ///< of a printed line, in characters

/// The procedure as plain text, to be read, ticked and signed on paper: its head, the four parts with a box a step, who,
/// the text as it stands with its redlines, what is checked by itself, commands, ways on, holds and time limits.
std::string printed(const Procedure& procedure, const dictionary::Dictionary& dictionary);

}  // namespace aeolis::server::procedures
