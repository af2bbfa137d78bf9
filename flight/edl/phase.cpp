// SPDX-License-Identifier: Apache-2.0
#include "flight/edl/phase.hpp"

#include <optional>

namespace aeolis::flight {
namespace {

/// Phase event of a GNC mode; none while GNC is off.
std::optional<EdlPhaseEvent> event_of(gnc::Mode mode) {
    using gnc::Mode;
    switch (mode) {
    case Mode::off: return std::nullopt;
    case Mode::approach: return EdlPhaseEvent::approach;
    case Mode::wait_for_guidance_start: return EdlPhaseEvent::wait_for_guidance;
    case Mode::range_control: return EdlPhaseEvent::range_control;
    case Mode::heading_alignment: return EdlPhaseEvent::heading_alignment;
    case Mode::straighten_up: return EdlPhaseEvent::straighten_up;
    case Mode::wait_for_parachute: return EdlPhaseEvent::wait_for_parachute;
    case Mode::parachute_descent: return EdlPhaseEvent::parachute_descent;
    case Mode::free_fall:
    case Mode::powered_approach:
    case Mode::constant_velocity:
    case Mode::constant_deceleration: return EdlPhaseEvent::powered_descent;
    case Mode::sky_crane: return EdlPhaseEvent::sky_crane;
    case Mode::touchdown:
    case Mode::flyaway: return EdlPhaseEvent::touchdown;
    }
    return std::nullopt;
}

}  // namespace

void Phase::take(EdlPhaseEvent event, PhaseChanges& changes) {
    const EdlPhase from = state();
    if (machine_.take(event)) changes.push_back({from, event, state()});
}

PhaseChanges Phase::follow(gnc::Mode mode, const gnc::Configuration& configuration, const Approach& approach) {
    PhaseChanges changes;
    take(approach.late_cruise ? EdlPhaseEvent::late_cruise_begins : EdlPhaseEvent::entry_moves_away, changes);
    if (approach.begun) take(EdlPhaseEvent::do_edl, changes);
    if (approach.pre_edl_over) take(EdlPhaseEvent::pre_edl_ends, changes);
    if (configuration.cruise_stage_gone) take(EdlPhaseEvent::cruise_stage_gone, changes);
    if (const auto event = event_of(mode)) take(*event, changes);
    if (configuration.engines_off) take(EdlPhaseEvent::engines_off, changes);
    return changes;
}

}  // namespace aeolis::flight
