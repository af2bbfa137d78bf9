#pragma once

#include "flight/gnc/edl_gnc.hpp"
#include "flight/kernel/outbox.hpp"

#include <optional>

// What GNC starts, in the words of the timeline and of the ground: anchor, event, explanation. R17, R38
namespace aeolis::flight {

/// The anchor that becomes defined; none where nothing on the timeline waits for it.
std::optional<AnchorId> anchor_of(gnc::Trigger trigger);

void announce(gnc::Trigger trigger, const gnc::Output& gnc, Outbox& out);
void announce_bank_reversal(const gnc::Output& gnc, Outbox& out);

/// The conditions that led to the decision, with their values and bounds.
void explain(gnc::Trigger trigger, const gnc::Output& gnc, Outbox& out);

/// Why "do edl" was accepted or refused. R23
void explain_do_edl(std::optional<CommandRefusal> refused, MaybeTime entry, MaybeTime first_desired,
                    double late_cruise_before_entry_s, Outbox& out);

}  // namespace aeolis::flight
