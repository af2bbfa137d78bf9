// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "server/procedures/procedure.hpp"

#include <string>

namespace aeolis::server::procedures {

inline constexpr std::size_t page_columns = 78;  ///< of a printed line, in characters

/// The procedure as plain text, to be read, ticked and signed on paper: its head and four parts. Each step has a box,
/// who does it, its text with redlines, what is checked by itself, its command, the ways on, its hold and time limits.
std::string printed(const Procedure& procedure, const dictionary::Dictionary& dictionary);

}  // namespace aeolis::server::procedures
