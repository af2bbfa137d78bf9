// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_queue.hpp"
#include "flight/kernel/outbox.hpp"
#include "flight/timeline/timeline.hpp"

#include <array>
#include <bitset>
#include <span>

namespace aeolis::flight {

using timeline::Moment;

/// A row of constraints.csv: minimum_s <= to - from <= maximum_s; undefined: no bound.
struct ConstraintSpec {
    Moment from, to;
    MaybeOffset minimum_s, maximum_s;
};
extern const std::array<ConstraintSpec, constraint_count> constraint_specs;

inline constexpr std::size_t constraint_rows_max = 256;  ///< chosen: three times the shipped sheet
static_assert(constraint_count <= constraint_rows_max, "constraints.csv has more rows than flight keeps room for");

/// Checks constraints.csv in flight. R39
/// Its required rows are the sub-constraints behind the timeline's rolled-up offsets. The given rows are bounds on GNC
/// and ground, assumed when the timeline was proven. A second opinion: it only reports, and nothing in flight depends
/// on it.
///
/// In      do edl, anchors and firings, as the timeline has them after a pass
/// Out     for each row that does not hold SUB_CONSTRAINT_VIOLATED and an Explanation; SUB_CONSTRAINTS_JUDGED at the
///         end
/// Rule    a row is judged when its `to` occurs, and again when that moves (an anchor set again). If `from` is unknown
///         then, the row is judged as soon as `from` is known. A row whose `from` or `to` never occurs is never judged
/// Rate    each cycle; at most four reports a cycle, so that the outbox always has room for EDL's own messages
/// Reset   times before a restart or a hand-over are not carried over: rows that reach back over it are not judged
/// Memory  fixed; the rows stay in the autocoder's table
/// Faults  with 64 reports waiting, further ones are dropped; each report gives the total number of violations
class ConstraintMonitor {
  public:
    explicit ConstraintMonitor(std::span<const ConstraintSpec> rows);

    /// Takes the results of a timeline pass; anchors first, since other moments are judged by them.
    void watch(const Timeline& timeline, std::span<const Firing> firings);

    /// Records that a moment has occurred, or changed its time. Undefined: its time is no longer known.
    void note(const Moment& moment, MaybeTime time);

    /// Reports violations found, a few per cycle.
    void report(Outbox& out);

    /// Reports the numbers of rows judged and of violations; called when the timeline is complete.
    void summarise(Outbox& out) const;

    std::uint32_t violations() const { return violations_; }

  private:
    struct Violation {
        std::uint16_t row = 0;
        double elapsed_s = 0.0;
    };

    MaybeTime& time_of(const Moment& moment);
    void judge(std::size_t row);

    std::span<const ConstraintSpec> rows_;
    MaybeTime do_edl_;
    std::array<MaybeTime, anchors_max> anchors_{};
    std::array<MaybeTime, timeline_rows_max> triggered_{};
    std::array<MaybeTime, timeline_rows_max> fired_{};
    std::bitset<constraint_rows_max> judged_;
    FixedQueue<Violation, 64> waiting_;
    std::uint32_t violations_ = 0;
};

}  // namespace aeolis::flight
