// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/archive/records.hpp"
#include "server/rehearsal/rehearsal.hpp"
#include "server/shadow/heard_flight.hpp"
#include "simulation/placed_state.hpp"
#include "simulation/scenario.hpp"

#include <cstdint>
#include <functional>
#include <memory>

// The ground's own flight: what it expects of the vehicle by what it knows, and nothing of the truth.
namespace aeolis::server::shadow {

/// A flight of the ground's, at the instant that was asked for, and how well it knows where the vehicle is.
struct GroundFlight {
    std::unique_ptr<Rehearsal> rehearsal;
    simulation::StateKnowledge knowledge;
    std::optional<Sclk> heard;  ///< the navigated state that it was last held against; none: ground's solution alone
};

/// An instant of a run, by the cycle at the vehicle.
struct Instant {
    std::uint64_t cycle = 0;
    bool with_requests = false;  ///< what was sent at that very cycle counts
};

/// What a scenario says that ground knows before the landing; of its errors only how large they may be.
simulation::Scenario ground_scenario(const simulation::Scenario& scenario);

/// Flies the landing as ground expects it, with the commands that it sent, from ground's solution on. Each state that
/// the vehicle told is taken over: the flight is moved to it, and what its navigation believes.
///
/// @param solution  ground's navigation solution
/// @param run       whose commands were sent; faults and forks in it are the instructor's and are left out
/// @param heard     from nothing but what ground received by the instant
/// Faults  an Error names a warning that the vehicle told and ground does not expect, where both timelines stand when
///         they stand apart, or a command that would be refused; or it says that the ground's flight is over by then, or
///         was stopped
Result<GroundFlight> fly_by_ground(const simulation::Scenario& scenario, const simulation::NavigationSolution& solution,
                                   const archive::FlownRun& run, const HeardFlight& heard, Instant instant,
                                   const dictionary::Dictionary& dictionary, const std::function<bool()>& stop);

}  // namespace aeolis::server::shadow
