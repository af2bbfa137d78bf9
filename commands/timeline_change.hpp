// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands/encoder.hpp"
#include "dictionaries/dictionary.hpp"
#include "dictionaries/timeline_plan.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace aeolis::commands {

/// Whether flight gives the command to the timeline: it changes an offset of a timepoint or an anchor. R19
bool changes_offsets(std::string_view command);

/// Does to the timeline of `dictionary` what flight does when such a command is executed; nothing where the row it
/// names is not there, or for any other command.
void apply_offsets(dictionary::Dictionary& dictionary, std::string_view command, std::span<const NamedValue> arguments);

/// What such a command, or another time of entry in "set edl parameters", changes on board. None for any other command,
/// and where the row it names is not there or an argument is missing.
std::optional<dictionary::OffsetChange> offset_change(const dictionary::Dictionary& dictionary,
                                                      std::string_view command, std::span<const NamedValue> arguments);

/// Indices of the timepoints that such a command moves by itself: the one that it names, or those that hang on the
/// anchor that it names. None for any other command.
std::vector<std::size_t> moved_timepoints(const dictionary::Dictionary& dictionary, std::string_view command,
                                          std::span<const NamedValue> arguments);

}  // namespace aeolis::commands
