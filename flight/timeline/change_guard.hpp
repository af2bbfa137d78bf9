// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/timeline_change_rule.hpp"
#include "flight/timeline/constraint_monitor.hpp"
#include "flight/timeline/timeline.hpp"
#include "generated/dictionary_flight.hpp"

#include <optional>
#include <span>

namespace aeolis::flight {

/// Judges a change of the timeline on board when it arrives, independently of ground. R51
///
/// In      "do edl", the firings; a change, with the timeline as it stands      Out   why the change is unsafe
/// Rule    dictionaries/timeline_change_rule.hpp. Dispatch is not judged: after a restart or a hand-over, overdue
///         timepoints fire together
/// Reset   the firings are part of the state that the other computer gets: it judges with all of them
/// Memory  fixed: the times of past firings, and the two projections of the last change
class ChangeGuard {
  public:
    explicit ChangeGuard(std::span<const ConstraintSpec> constraints) : constraints_(constraints) {}

    void begin(Sclk do_edl_accepted) { known_.do_edl = do_edl_accepted; }
    /// Records the firings of a pass.
    void watch(const Timeline& timeline, std::span<const Firing> firings);

    std::optional<timeline::Unsafe> judge(const Timeline& timeline, const timeline::Change& change, Sclk now);

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(known_.do_edl);
        for (auto* times : {&known_.triggered, &known_.fired})
            exchange.departures(
                timepoint_count, [&](std::size_t row) -> MaybeTime& { return (*times)[row]; },
                [](std::size_t) { return MaybeTime{}; });
    }

  private:
    std::span<const ConstraintSpec> constraints_;
    timeline::Times known_;
    timeline::Times before_, after_;
};

}  // namespace aeolis::flight
