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

/// A row of constraints.csv, as the autocoder writes it: minimum_s <= to - from <= maximum_s; undefined: no bound.
struct ConstraintSpec {
    Moment from, to;
    MaybeOffset minimum_s, maximum_s;
};
extern const std::array<ConstraintSpec, constraint_count> constraint_specs;

inline constexpr std::size_t constraint_rows_max = 256;  ///< ours: three times the shipped sheet
static_assert(constraint_count <= constraint_rows_max, "constraints.csv has more rows than flight keeps room for");

/// Checks in flight the sub-constraints behind the timeline's rolled-up offsets, and what GNC and ground were held to
/// when the timeline was proven. A second opinion: it only tells, and nothing in flight asks it. R39
///
/// In      do edl, the anchors, the firings, as the timeline has them after a pass
/// Out     for each row that does not hold SUB_CONSTRAINT_VIOLATED and an Explanation; SUB_CONSTRAINTS_JUDGED at the
///         end
/// Rule    a row is judged when its `to` comes, and again when that moves (an anchor set anew); when `from` was not
///         known by then, as soon as it is. A row whose `from` or `to` never comes is never judged
/// Rate    each cycle; at most four reports a cycle, so that the outbox always has room for what EDL itself must send
/// Reset   what a computer saw before a restart or a hand-over is not handed on: rows that reach back over it are not
///         judged
/// Memory  fixed; the rows are read where the autocoder put them
/// Faults  with 64 reports waiting the next are dropped; each report tells how many violations there were in all
class ConstraintMonitor {
  public:
    explicit ConstraintMonitor(std::span<const ConstraintSpec> rows);

    /// What the timeline did in a pass: its anchors first, for what hangs on one is judged by it.
    void watch(const Timeline& timeline, std::span<const Firing> firings);

    /// A moment has come, or stands at another time than before. Undefined: it is not known any more.
    void note(const Moment& moment, MaybeTime time);

    /// Tells what was found, some a cycle.
    void report(Outbox& out);

    /// How many rows were judged, and how many violations there were: said when the timeline is complete.
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
