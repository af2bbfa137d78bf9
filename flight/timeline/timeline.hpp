// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_vector.hpp"
#include "dictionaries/timeline_rule.hpp"
#include "flight/kernel/message.hpp"
#include "flight/timeline/timepoint.hpp"

#include <span>

namespace aeolis::flight {

inline constexpr std::size_t timeline_rows_max = 160;  ///< ours: twice the shipped timeline
inline constexpr std::size_t anchors_max = 32;         ///< ours

using FiringVerdict = TimepointVerdict;  // completed, replied, timed_out, no_operation, failed

struct Firing {
    TimepointId timepoint;
    Sclk triggered;
    Sclk fired;
    FiringVerdict verdict{};
};

/// What one pass completes: the reply that was waited for, and what fires after it.
using Firings = FixedVector<Firing, timeline::triggered_per_cycle_max + 1>;

/// The engine that interprets the timeline, by dictionaries/timeline_rule.hpp. R11–R18
///
/// In       the clock, replies, changed offsets, anchors that GNC sets "now"
/// Out      actions through ActionContext; Firing for each timepoint that completed
/// Memory   fixed; the rows are read where the autocoder put them
/// Before the first timepoint stands the acceptance of "do edl" (R16): nothing happens before `begin`. Actions may be
/// repeated: after a restart in pre-EDL, and when Second Chance finds one whose reply prime still awaited.
class Timeline {
  public:
    /// `essential_only`: Second Chance, where the other rows' actions are no operation. R33
    Timeline(std::span<const TimepointSpec> rows, std::span<const AnchorSpec> anchors, bool essential_only = false);

    void begin(Sclk do_edl_accepted);
    bool begun() const { return begun_; }
    bool finished() const { return current_ == rows_.size(); }

    /// A new 64 Hz cycle: the limit of firings starts anew, both passes together count.
    void begin_cycle() { fired_in_cycle_ = 0; }

    /// One pass: anchors first, then the current timepoint, and the next while no reply is awaited. R15, R16
    void pass(Sclk now, ActionContext& context, Firings& firings);

    /// Whether only the limit of firings keeps the current timepoint from firing in this cycle. R15
    bool limited(Sclk now) const;

    /// The answer that the current timepoint may be waiting for. It counts at the next pass. R14
    void reply(const ActionReply& reply);

    // Offsets may be changed between cycles and propagate fully in the next pass. False: no such row. R16
    [[nodiscard]] bool set_timepoint_offsets(TimepointId id, MaybeOffset desired_s, MaybeOffset minimum_s);
    [[nodiscard]] bool set_anchor_offset(AnchorId id, MaybeOffset offset_s);
    /// GNC's "now": from this moment the anchor is defined, and what is relative to it. R17
    void set_anchor_now(AnchorId id, Sclk now);

    MaybeTime anchor_time(AnchorId id) const { return anchor_times_[id.value]; }
    TimepointId current() const { return {static_cast<std::uint16_t>(current_)}; }
    TimepointState state() const;
    /// The current timepoint's action was triggered, and its reply is due.
    struct Waiting {
        Sclk triggered;
        double timeout_s = 0.0;
    };
    std::optional<Waiting> waiting() const;
    /// Times from which the current timepoint may fire; undefined when it is not known yet.
    MaybeTime next_desired() const;
    MaybeTime next_minimum() const;
    /// Latest time at which the timeline may begin without anything being overdue. Undefined before the parameters came.
    MaybeTime first_desired() const;
    void compute_anchors();

    /// After a restart: back to the timepoint that the current one names, with nothing awaited. False when it names
    /// none and goes on where it was. R32
    bool backtrack(Sclk now);
    /// The action whose reply another computer awaited is run again at the next pass. R33
    void await_nothing() { waiting_ = replied_ = false; }

    template <typename Exchange>
    void carry(Exchange& exchange) {
        for (std::size_t i = 0; i < rows_.size(); ++i) exchange(desired_offset_s_[i], minimum_offset_s_[i]);
        for (std::size_t i = 0; i < anchors_.size(); ++i) exchange(anchor_offset_s_[i]);
        exchange(previous_fired_, current_, begun_, waiting_, triggered_);
        compute_anchors();
    }

  private:
    void complete(Sclk now, FiringVerdict verdict, Firings& firings);
    timeline::Offsets offsets(std::size_t row) const;
    timeline::DueTimes current_due() const;
    bool runs(const TimepointSpec& row) const { return !essential_only_ || row.essential || !row.action; }

    std::span<const TimepointSpec> rows_;
    std::span<const AnchorSpec> anchors_;
    bool essential_only_;
    std::array<MaybeOffset, timeline_rows_max> desired_offset_s_{};
    std::array<MaybeOffset, timeline_rows_max> minimum_offset_s_{};
    std::array<MaybeOffset, anchors_max> anchor_offset_s_{};
    std::array<MaybeTime, anchors_max> anchor_times_{};
    MaybeTime previous_fired_;
    std::size_t current_ = 0;
    std::size_t fired_in_cycle_ = 0;
    bool begun_ = false;
    bool waiting_ = false;  // for the reply of the current timepoint
    bool replied_ = false;
    ActionReply awaited_;
    Sclk triggered_;
};

}  // namespace aeolis::flight
