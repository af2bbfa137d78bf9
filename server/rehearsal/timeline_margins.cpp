// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/timeline_margins.hpp"

#include <algorithm>

namespace aeolis::server {
namespace {

/// The anchor from which the plan knows the distance of this one: itself, where only the landing decides it.
AnchorId base_of(const dictionary::Dictionary& dictionary, AnchorId anchor) {
    for (;;) {
        const auto& row = dictionary.anchors[anchor.value];
        if (!row.parent || !row.offset_s) return anchor;
        anchor = *row.parent;
    }
}

/// Whether the sequence passes at this row from one anchor to another whose distance only the landing decides. Between
/// others the plan keeps the distance, and its analysis proves it. Rows that may be late have no margin to keep.
bool begins_after_another_anchor(const dictionary::Dictionary& dictionary, std::size_t row) {
    const auto& timeline = dictionary.timeline;
    const auto held_to = [&](std::size_t i) { return timeline[i].anchor && !timeline[i].may_be_late; };
    if (!held_to(row)) return false;
    for (std::size_t before = row; before-- > 0;)
        if (held_to(before))
            return base_of(dictionary, *timeline[before].anchor) != base_of(dictionary, *timeline[row].anchor);
    return true;
}

}  // namespace

std::vector<TimelineMargin> timeline_margins(const std::vector<RecordedFiring>& firings,
                                             const dictionary::Dictionary& dictionary, double after_sclk) {
    std::vector<TimelineMargin> margins;
    for (std::size_t i = 1; i < firings.size(); ++i) {
        const RecordedFiring& firing = firings[i];
        if (firing.row >= dictionary.timeline.size() || firing.triggered_sclk < after_sclk) continue;
        const auto& row = dictionary.timeline[firing.row];
        if (!row.minimum_offset_s || !begins_after_another_anchor(dictionary, firing.row)) continue;
        margins.push_back({firing.name, firing.triggered_sclk - (firings[i - 1].fired_sclk + *row.minimum_offset_s)});
    }
    return margins;
}

std::optional<double> least_timeline_margin_s(const std::vector<RecordedFiring>& firings,
                                              const dictionary::Dictionary& dictionary) {
    const auto margins = timeline_margins(firings, dictionary);
    const auto least = std::ranges::min_element(margins, {}, &TimelineMargin::margin_s);
    return least == margins.end() ? std::nullopt : std::optional{least->margin_s};
}

}  // namespace aeolis::server
