// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/findings.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace aeolis::dictionary::xtce {

/// Converts the text of an XML file to UTF-8, without a byte order mark, so that lines can be counted in it.
/// Its encoding is told by the byte order mark, else by the declaration: UTF-8, US-ASCII, ISO-8859-1, UTF-16 in either
/// order. None, with a finding that names it, for another encoding, when mark and declaration differ, and for octets or
/// character references that are no characters. [xml-1.0] 4.3.3
std::optional<std::string> to_utf8(std::string_view text, Findings& findings);

}  // namespace aeolis::dictionary::xtce
