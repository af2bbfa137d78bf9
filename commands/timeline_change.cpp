// SPDX-License-Identifier: Apache-2.0
#include "commands/timeline_change.hpp"

#include <algorithm>

namespace aeolis::commands {
namespace {

// The commands that move the timeline on board. The third one only moves the anchor "entry".
constexpr std::string_view timepoint_offset = "EDL_SET_TIMEPOINT_OFFSET";
constexpr std::string_view anchor_offset = "EDL_SET_ANCHOR_OFFSET";
constexpr std::string_view parameters = "EDL_SET_PARAMETERS";

double argument_of(std::span<const NamedValue> arguments, std::string_view name) {
    const auto found = std::ranges::find(arguments, name, &NamedValue::name);
    return found == arguments.end() ? -1.0 : found->value;
}

MaybeOffset given(std::span<const NamedValue> arguments, std::string_view name) {
    const auto found = std::ranges::find(arguments, name, &NamedValue::name);
    return found == arguments.end() ? MaybeOffset{} : MaybeOffset{found->value};
}

template <typename Rows>
auto* row_at(Rows& rows, double index) {
    using Row = decltype(&rows[0]);
    return index >= 0.0 && index < static_cast<double>(rows.size()) ? &rows[static_cast<std::size_t>(index)]
                                                                    : Row{nullptr};
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

std::optional<dictionary::OffsetChange> offset_change(const dictionary::Dictionary& dictionary,
                                                      std::string_view command, std::span<const NamedValue> arguments) {
    using dictionary::OffsetChange;
    if (command == timepoint_offset) {
        const auto* row = row_at(dictionary.timeline, argument_of(arguments, "timepoint"));
        const auto desired_s = given(arguments, "desired_offset_s"), minimum_s = given(arguments, "minimum_offset_s");
        if (row == nullptr || !desired_s || !minimum_s) return std::nullopt;
        return OffsetChange{.what = OffsetChange::OfTimepoint{row->id, desired_s, minimum_s}};
    }
    const auto of_anchor = [](const dictionary::AnchorRow* row, MaybeOffset offset_s) -> std::optional<OffsetChange> {
        if (row == nullptr || !row->parent || !offset_s) return std::nullopt;
        return OffsetChange{.what = OffsetChange::OfAnchor{row->id, offset_s}};
    };
    if (command == anchor_offset)
        return of_anchor(row_at(dictionary.anchors, argument_of(arguments, "anchor")), given(arguments, "offset_s"));
    if (command != parameters) return std::nullopt;
    const auto entry = std::ranges::find(dictionary.anchors, "entry", &dictionary::AnchorRow::name);
    return of_anchor(entry == dictionary.anchors.end() ? nullptr : &*entry, given(arguments, "entry_sclk"));
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
