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

/// Whether flight hands the command to the timeline: it changes an offset of a timepoint or an anchor. R19
bool changes_offsets(std::string_view command);

/// Applies to the timeline of `dictionary` what flight does when it executes the command. Does nothing for other
/// commands, or when the named row does not exist.
void apply_offsets(dictionary::Dictionary& dictionary, std::string_view command, std::span<const NamedValue> arguments);

/// The change that the command makes on board: of an offset, or of the entry time in "set edl parameters". None for
/// other commands, when the named row does not exist, or when an argument is missing.
std::optional<dictionary::OffsetChange> offset_change(const dictionary::Dictionary& dictionary,
                                                      std::string_view command, std::span<const NamedValue> arguments);

/// Indices of the timepoints that the command moves directly: the one it names, or those relative to the anchor it
/// names. None for other commands.
std::vector<std::size_t> moved_timepoints(const dictionary::Dictionary& dictionary, std::string_view command,
                                          std::span<const NamedValue> arguments);

}  // namespace aeolis::commands
