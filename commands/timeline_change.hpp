#pragma once

#include "commands/encoder.hpp"
#include "dictionaries/dictionary.hpp"

#include <span>
#include <string_view>

namespace aeolis::commands {

/// Whether flight gives the command to the timeline: it changes an offset of a timepoint or an anchor. R19
bool changes_offsets(std::string_view command);

/// Does to the timeline of `dictionary` what flight does when such a command is executed; nothing where the row it names is not
/// there, or for any other command.
void apply_offsets(dictionary::Dictionary& dictionary, std::string_view command, std::span<const NamedValue> arguments);

} // namespace aeolis::commands
