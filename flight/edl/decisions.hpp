// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/explanation/held_explanations.hpp"
#include "flight/gnc/edl_gnc.hpp"
#include "flight/kernel/outbox.hpp"
#include "flight/timeline/timeline.hpp"

#include <optional>

// What GNC starts, in the words of the timeline and of the ground: anchor, event, explanation. R17, R38
namespace aeolis::flight {

Decision decision_of(gnc::Trigger trigger);

/// The anchor that becomes defined; none where nothing on the timeline waits for it.
std::optional<AnchorId> anchor_of(gnc::Trigger trigger);

void announce(gnc::Trigger trigger, const gnc::Output& gnc, Outbox& out);
void announce_bank_reversal(const gnc::Output& gnc, Outbox& out);

/// The conditions that led to the decision, with their values and bounds; and how often it was held untold before.
void explain(gnc::Trigger trigger, const gnc::Output& gnc, std::uint16_t suppressed, Outbox& out);

/// What GNC is near to deciding, and which condition is missing.
void explain_held(const gnc::Output& gnc, HeldExplanations& held, Outbox& out);

/// What the timeline waits for when its time has come: its minimum offset, or a reply.
void explain_held(const Timeline& timeline, HeldExplanations& held, Outbox& out);

/// Says when the largest sensed deceleration of the entry has passed.
class PeakDeceleration {
  public:
    void watch(const gnc::Output& gnc, Outbox& out);

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(largest_mps2_, altitude_m_, speed_mps_, passed_);
    }

  private:
    double largest_mps2_ = 0.0;
    double altitude_m_ = 0.0;
    double speed_mps_ = 0.0;
    bool passed_ = false;
};

/// Why "do edl" was accepted or refused. R23
void explain_do_edl(std::optional<CommandRefusal> refused, MaybeTime entry, MaybeTime first_desired, Outbox& out);

}  // namespace aeolis::flight
