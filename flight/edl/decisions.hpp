// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/edl/phase.hpp"
#include "flight/explanation/held_explanations.hpp"
#include "flight/gnc/edl_gnc.hpp"
#include "flight/kernel/outbox.hpp"
#include "flight/timeline/timeline.hpp"

#include <optional>

// Announces GNC's triggers to the timeline as anchors, and to ground as events. Explains what EdlMain decides. R17, R38
namespace aeolis::flight {

Decision decision_of(gnc::Trigger trigger);

/// The anchor that becomes defined; none when no timepoint depends on the trigger.
std::optional<AnchorId> anchor_of(gnc::Trigger trigger);

void announce(gnc::Trigger trigger, const gnc::Output& gnc, Outbox& out);
void announce_bank_reversal(const gnc::Output& gnc, Outbox& out);

/// Explains a decision by its own conditions, with values and bounds.
/// `suppressed`: number of held explanations that were not sent before it.
void explain(const gnc::JudgedTrigger& fired, std::uint16_t suppressed, Outbox& out);
void explain(const gnc::ModeChange& change, Outbox& out);
void explain(const gnc::RadarDecision& decision, Outbox& out);
/// Explains a change of phase. `entry`: the time of entry, by which late cruise is judged.
void explain(const PhaseChange& change, MaybeTime entry, Outbox& out);

/// Explains triggers that are near, and which of their conditions are missing.
void explain_held(const gnc::Output& gnc, HeldExplanations& held, Outbox& out);

/// Explains why the timeline waits although its time has come: for its minimum offset, or for a reply.
void explain_held(const Parameters& parameters, const Timeline& timeline, HeldExplanations& held, Outbox& out);

/// Announces the largest sensed deceleration of the entry once it has passed.
class PeakDeceleration {
  public:
    void watch(const Parameters& parameters, const gnc::Output& gnc, Outbox& out);

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

}  // namespace aeolis::flight
