#include "flight/edl/phase.hpp"

namespace aeolis::flight {

EdlPhase phase_of(gnc::Mode mode, const gnc::Configuration& configuration, bool late_cruise) {
    using gnc::Mode;
    switch (mode) {
    case Mode::off:
        if (configuration.cruise_stage_gone) return EdlPhase::exo_atmospheric;
        return late_cruise ? EdlPhase::late_cruise : EdlPhase::pre_edl;
    case Mode::approach: return EdlPhase::exo_atmospheric;
    case Mode::wait_for_guidance_start: return EdlPhase::wait_for_guidance;
    case Mode::range_control: return EdlPhase::range_control;
    case Mode::heading_alignment: return EdlPhase::heading_alignment;
    case Mode::straighten_up: return EdlPhase::straighten_up;
    case Mode::wait_for_parachute: return EdlPhase::wait_for_parachute;
    case Mode::parachute_descent: return EdlPhase::parachute_descent;
    case Mode::free_fall:
    case Mode::powered_approach:
    case Mode::constant_velocity:
    case Mode::constant_deceleration: return EdlPhase::powered_descent;
    case Mode::sky_crane: return EdlPhase::sky_crane;
    case Mode::touchdown:
    case Mode::flyaway: return configuration.engines_off ? EdlPhase::landed : EdlPhase::flyaway;
    }
    return EdlPhase::pre_edl;
}

}  // namespace aeolis::flight
