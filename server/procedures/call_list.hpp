// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/procedures/procedure.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::server::procedures {

inline constexpr std::size_t says_characters_max = 60;  ///< chosen: what is said in one breath, and stands in a menu

/// What somebody says by one key.
struct StandardCall {
    std::string id;
    char key = ' ';    ///< a small letter or a digit
    std::string says;  ///< "Parachute seen"
    std::string asks;  ///< what is given with it, in words; empty: nothing
};

/// The standard calls of a mission's control room. Without any none can be made.
struct CallList {
    double read_back_s = 0.0;  ///< within so long a call should be read back
    std::vector<StandardCall> calls;

    /// Null: there is none of the id.
    const StandardCall* call(std::string_view id) const;
};

/// The calls, or every rule that the text breaks, in the order of the text.
struct ReadCalls {
    std::optional<CallList> calls;  ///< none when there are findings
    std::vector<TextFinding> findings;
};

/// Reads the standard calls: all faults in one pass, each with its line and column.
///
/// @param text  YAML; docs/rehearsals.md has its form
/// @param file  its name in findings; with an ending, the name before it is the list's id
///
/// Checked: names that the form does not have; missing parts; ids, keys and words that stand twice; keys of more than a
/// small letter or a digit; words that are too long.
ReadCalls read_calls(std::string_view text, const std::string& file);

}  // namespace aeolis::server::procedures
