// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/rehearsal/timeline_margins.hpp"
#include "simulation/landing.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace aeolis::server::campaign {

struct CaseEvent {
    std::string name;
    double e_s = 0.0, altitude_m = 0.0, speed_mps = 0.0;
    double east_m = 0.0, north_m = 0.0;  ///< relative to the target
};

/// The stored result of one case.
struct CaseResult {
    std::uint64_t number = 0;
    std::string outcome, reason;  ///< the same words as of a rehearsal: touchdown, impact, lost, not_commanded, timeout
    std::uint64_t limits_exceeded = 0;  ///< of the scenario's: a landing outside limits; `reason` names them
    std::uint64_t end_cycle = 0;        ///< 64 Hz cycles from the landing's start to its end
    std::optional<simulation::TouchdownReport> touchdown;
    double east_m = 0.0, north_m = 0.0;  ///< relative to the target, when there was a touchdown
    std::optional<simulation::ParachuteReport> parachute;
    simulation::SeparationReport separation;
    double peak_deceleration_mps2 = 0.0;
    double propellant_kg = 0.0;           ///< left at the end, after fly-away
    std::vector<TimelineMargin> margins;  ///< in the order of the timeline
    std::vector<CaseEvent> events;
    std::vector<simulation::Draw> draws;
};

}  // namespace aeolis::server::campaign
