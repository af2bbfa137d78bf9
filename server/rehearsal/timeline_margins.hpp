// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "server/rehearsal/recorded_firings.hpp"

#include <optional>
#include <string>
#include <vector>

namespace aeolis::server {

/// How long a timepoint was triggered after its earliest permitted time. That time is its minimum offset after the
/// previous firing.
struct TimelineMargin {
    std::string timepoint;
    double margin_s = 0.0;
};

/// The margins of a landing: for each timepoint that passes from one anchor to the next and fired after `after_sclk`, how
/// long after its minimum offset permitted it was it triggered. Zero: the timeline held it up. Margins within an
/// anchor's own sequence are the timeline's design and say nothing about the case. Minimum offsets are the
/// dictionary's.
std::vector<TimelineMargin> timeline_margins(const std::vector<RecordedFiring>& firings,
                                             const dictionary::Dictionary& dictionary, double after_sclk = 0.0);

/// The least of them all; none: nothing was fired.
std::optional<double> least_timeline_margin_s(const std::vector<RecordedFiring>& firings,
                                              const dictionary::Dictionary& dictionary);

}  // namespace aeolis::server
