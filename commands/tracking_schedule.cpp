// SPDX-License-Identifier: Apache-2.0
#include "commands/tracking_schedule.hpp"

#include <algorithm>

namespace aeolis::commands {

TrackingSchedule::TrackingSchedule(std::vector<TrackingPass> passes) : passes_(std::move(passes)) {
    std::ranges::stable_sort(passes_, {}, &TrackingPass::begin);
}

const TrackingPass* TrackingSchedule::pass_at(Ert at) const {
    const TrackingPass* longest = nullptr;
    for (const TrackingPass& pass : passes_)
        if (pass.begin <= at && at < pass.end && (longest == nullptr || longest->end < pass.end)) longest = &pass;
    return longest;
}

const TrackingPass* TrackingSchedule::next_after(Ert at) const {
    const auto next = std::ranges::find_if(passes_, [&](const TrackingPass& pass) { return pass.begin > at; });
    return next == passes_.end() ? nullptr : &*next;
}

std::string TrackingSchedule::refusal(Ert at) const {
    std::string text = "no station sees the vehicle at " + day_of_year_text(at);
    const TrackingPass* last = nullptr;
    for (const TrackingPass& pass : passes_)
        if (pass.end <= at && (last == nullptr || last->end < pass.end)) last = &pass;
    text += last == nullptr ? ": no pass was before"
                            : ": the last pass, of " + last->station + ", ended " + day_of_year_text(last->end);
    const auto* next = next_after(at);
    if (next == nullptr) return text + "; none comes after it";
    return text + "; the next, of " + next->station + ", is " + day_of_year_text(next->begin) + " to " +
           day_of_year_text(next->end) + ": give a release time within it";
}

}  // namespace aeolis::commands
