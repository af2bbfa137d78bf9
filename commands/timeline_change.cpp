// SPDX-License-Identifier: Apache-2.0
#include "commands/timeline_change.hpp"

#include <algorithm>

namespace aeolis::commands {
namespace {

// The commands that flight's command dispatcher gives to the timeline.
constexpr std::string_view timepoint_offset = "EDL_SET_TIMEPOINT_OFFSET";
constexpr std::string_view anchor_offset = "EDL_SET_ANCHOR_OFFSET";

double argument_of(std::span<const NamedValue> arguments, std::string_view name) {
    const auto found = std::ranges::find(arguments, name, &NamedValue::name);
    return found == arguments.end() ? -1.0 : found->value;
}

template <typename Row>
Row* row_at(std::vector<Row>& rows, double index) {
    return index >= 0.0 && index < static_cast<double>(rows.size()) ? &rows[static_cast<std::size_t>(index)] : nullptr;
}

}  // namespace

bool changes_offsets(std::string_view command) {
    return command == timepoint_offset || command == anchor_offset;
}

void apply_offsets(dictionary::Dictionary& dictionary, std::string_view command,
                   std::span<const NamedValue> arguments) {
    if (command == timepoint_offset) {
        auto* timepoint = row_at(dictionary.timeline, argument_of(arguments, "timepoint"));
        if (timepoint == nullptr) return;
        timepoint->desired_offset_s = argument_of(arguments, "desired_offset_s");
        timepoint->minimum_offset_s = argument_of(arguments, "minimum_offset_s");
    } else if (command == anchor_offset) {
        auto* anchor = row_at(dictionary.anchors, argument_of(arguments, "anchor"));
        if (anchor != nullptr) anchor->offset_s = argument_of(arguments, "offset_s");
    }
}

std::vector<std::size_t> moved_timepoints(const dictionary::Dictionary& dictionary, std::string_view command,
                                          std::span<const NamedValue> arguments) {
    std::vector<std::size_t> moved;
    const double timepoint = command == timepoint_offset ? argument_of(arguments, "timepoint") : -1.0;
    const double anchor = command == anchor_offset ? argument_of(arguments, "anchor") : -1.0;
    for (std::size_t i = 0; i < dictionary.timeline.size(); ++i) {
        const auto& hangs_on = dictionary.timeline[i].anchor;
        if (timepoint == static_cast<double>(i) || (hangs_on && anchor == static_cast<double>(hangs_on->value)))
            moved.push_back(i);
    }
    return moved;
}

}  // namespace aeolis::commands
