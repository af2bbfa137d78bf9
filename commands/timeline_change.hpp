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

/// Whether the command names a timepoint or an anchor and sets its offset. False for "set edl parameters", although its
/// entry time moves an anchor too. R19
bool changes_offsets(std::string_view command);

/// Changes the offsets in `dictionary` as flight changes its own when it executes the command. Does nothing unless
/// `changes_offsets(command)`, or when the named row does not exist. `arguments` must be complete.
void apply_offsets(dictionary::Dictionary& dictionary, std::string_view command, std::span<const NamedValue> arguments);

/// The same change as a value, without making it; also that of the entry time by "set edl parameters". None for other
/// commands, when the named row does not exist, or when an argument is missing.
std::optional<dictionary::OffsetChange> offset_change(const dictionary::Dictionary& dictionary,
                                                      std::string_view command, std::span<const NamedValue> arguments);

/// Rows of the timeline that the command moves directly: the timepoint that it names, or those whose offset counts from
/// the anchor that it names. Empty unless `changes_offsets(command)`.
std::vector<std::size_t> moved_timepoints(const dictionary::Dictionary& dictionary, std::string_view command,
                                          std::span<const NamedValue> arguments);

}  // namespace aeolis::commands
