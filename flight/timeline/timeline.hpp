// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_vector.hpp"
#include "dictionaries/timeline_change_rule.hpp"
#include "dictionaries/timeline_rule.hpp"
#include "flight/kernel/message.hpp"
#include "flight/timeline/timepoint.hpp"

#include <span>

namespace aeolis::flight {

using timeline::anchors_max;
inline constexpr std::size_t timeline_rows_max = timeline::rows_max;

using FiringVerdict = TimepointVerdict;  // completed, verified, unverified, no_operation, refused

struct Firing {
    TimepointId timepoint;
    Sclk triggered;
    Sclk fired;
    FiringVerdict verdict{};
    ActionReply asked;  ///< the awaited reply
    gnc::Fact fact{};   ///< the action's change of the configuration

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(timepoint, triggered, fired, verdict, asked, fact);
    }
};

/// Firings of one pass: the timepoint whose reply was awaited, and those that fire after it.
using Firings = FixedVector<Firing, timeline::triggered_per_cycle_max + 1>;

/// The engine that interprets the timeline, by dictionaries/timeline_rule.hpp. R11–R18
///
/// In       the clock, replies, changed offsets, anchors that GNC sets "now"
/// Out      actions through ActionContext; a Firing for each completed timepoint. A row's event, its tone and its
///          change of the configuration follow the reply, not the triggering. R50
/// Memory   fixed; the rows stay in the autocoder's table
/// The acceptance of "do edl" precedes the first timepoint (R16): nothing happens before begin(). Actions may be
/// repeated: after a restart in pre-EDL, and when Second Chance takes over while prime still awaited a reply.
class Timeline {
  public:
    /// `essential_only`: for Second Chance, in which the actions of non-essential rows do nothing. R33
    Timeline(std::span<const TimepointSpec> rows, std::span<const AnchorSpec> anchors, bool essential_only = false);

    void begin(Sclk do_edl_accepted);
    bool begun() const { return begun_; }
    bool finished() const { return current_ == rows_.size(); }

    /// Starts a new 64 Hz cycle: resets the limit of triggerings, which counts both passes together.
    void begin_cycle() { fired_in_cycle_ = 0; }

    /// One pass: anchors, the current timepoint, and the next ones while no reply is awaited. R15, R16
    void pass(Sclk now, ActionContext& context, Firings& firings);

    /// Whether only the limit per cycle keeps the current timepoint from being triggered now. R15
    bool limited(Sclk now) const;

    /// Takes a reply, for which the current timepoint may be waiting. It takes effect in the next pass. R14
    /// False: it is not waiting for this reply.
    bool reply(const ActionReply& reply);

    // Offsets may be changed between cycles; the next pass uses them everywhere. False: no such row. R16
    [[nodiscard]] bool set_timepoint_offsets(TimepointId id, MaybeOffset desired_s, MaybeOffset minimum_s);
    [[nodiscard]] bool set_anchor_offset(AnchorId id, MaybeOffset offset_s);
    /// GNC's "now": defines the anchor at `now`, and with it all times relative to it. R17
    void set_anchor_now(AnchorId id, Sclk now);

    MaybeTime anchor_time(AnchorId id) const { return anchor_times_[id.value]; }
    TimepointId current() const { return {static_cast<std::uint16_t>(current_)}; }
    TimepointState state() const;
    /// The current timepoint's action was triggered, and its reply is pending.
    struct Waiting {
        Sclk triggered;
        double timeout_s = 0.0;
    };
    std::optional<Waiting> waiting() const;
    /// Whether the action of a timepoint was triggered, in this cycle or before.
    bool triggered(TimepointId id) const;
    /// Times from which the current timepoint may fire; undefined while unknown.
    MaybeTime next_desired() const;
    MaybeTime next_minimum() const;
    /// Latest time at which the timeline may begin without anything being overdue.
    /// Undefined until parameters are received.
    MaybeTime first_desired() const;
    void compute_anchors();

    // The plan as it stands, for judges of a change.
    std::span<const TimepointSpec> rows() const { return rows_; }
    std::span<const AnchorSpec> anchors() const { return anchors_; }
    timeline::Offsets offsets(std::size_t row) const;
    MaybeOffset anchor_offset_s(std::size_t anchor) const { return anchor_offset_s_[anchor]; }
    MaybeTime previous_fired() const { return previous_fired_; }

    /// After a restart: returns to the current timepoint's backtrack row, with no reply awaited. R32
    /// `now` becomes the previous firing. False when there is no such row: the timeline continues where it was.
    bool backtrack(Sclk now);
    /// Forgets an awaited reply: the action runs again in the next pass. R33
    void await_nothing() { waiting_ = false; }

    template <typename Exchange>
    void carry(Exchange& exchange) {
        const auto in = [](auto& values) { return [&values](std::size_t i) -> auto& { return values[i]; }; };
        exchange.departures(rows_.size(), in(desired_offset_s_), [&](auto i) { return rows_[i].desired_offset_s; });
        exchange.departures(rows_.size(), in(minimum_offset_s_), [&](auto i) { return rows_[i].minimum_offset_s; });
        exchange.departures(anchors_.size(), in(anchor_offset_s_), [&](auto i) { return anchors_[i].offset_s; });
        exchange(previous_fired_, current_, begun_, waiting_, triggered_);
        compute_anchors();
    }

  private:
    void command(Sclk now, ActionContext& context);
    void await_reply(Sclk now, ActionContext& context, Firings& firings);
    void complete(Sclk now, FiringVerdict verdict, ActionContext& context, Firings& firings);
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
    ActionReply awaited_;   // with its latest evidence
    gnc::Fact fact_{};
    Sclk triggered_;
    Sclk commanded_;  // last time, by which a held timeline repeats the action
};

}  // namespace aeolis::flight
