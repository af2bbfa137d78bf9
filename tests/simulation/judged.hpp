// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/rehearsal/timeline_margins.hpp"
#include "simulation/limits.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/support/shipped_dictionary.hpp"

namespace aeolis::tests {

/// Judges a landing by all of its limits, as rehearsals and campaigns do: the timeline's margin is read from what the
/// landing recorded.
inline simulation::Judgement judged(const simulation::Landing& landing,
                                    const simulation::Limits& limits = gale_scenario().limits) {
    server::RecordedFirings firings{shipped_dictionary()};
    firings.read(landing.recording());
    const auto least_margin_s = server::least_timeline_margin_s(firings.all(), shipped_dictionary());
    return simulation::judge(limits, simulation::figures_of(landing, least_margin_s));
}

/// The same for a landing whose timeline a reset or a reply that is refused, late or absent holds up, as it must: the
/// margin of the timeline is not judged, because overdue rows fire together then.
inline simulation::Judgement judged_held_up(const simulation::Landing& landing,
                                            const simulation::Limits& limits = gale_scenario().limits) {
    return simulation::judge(limits, simulation::figures_of(landing));
}

}  // namespace aeolis::tests
