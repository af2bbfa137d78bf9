// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "server/rehearsal/recorded_firings.hpp"

#include <optional>
#include <string>
#include <vector>

namespace aeolis::server {

/// The time from a timepoint's earliest permitted time, its minimum offset after the previous firing, to its
/// triggering.
struct TimelineMargin {
    std::string timepoint;
    double margin_s = 0.0;
};

/// The margins of a landing, for each timepoint that leads from one anchor to the next, if only the landing decides the
/// distance of the two, and that fired after `after_sclk`: the time from when its minimum offset permitted it until it
/// was triggered. Zero: the timeline delayed it. Margins within an anchor's own sequence, or between anchors of the
/// clock, are the timeline's design and say nothing about the case. Minimum offsets are the
/// dictionary's.
std::vector<TimelineMargin> timeline_margins(const std::vector<RecordedFiring>& firings,
                                             const dictionary::Dictionary& dictionary, double after_sclk = 0.0);

/// The least of them all; none: nothing was fired.
std::optional<double> least_timeline_margin_s(const std::vector<RecordedFiring>& firings,
                                              const dictionary::Dictionary& dictionary);

}  // namespace aeolis::server
