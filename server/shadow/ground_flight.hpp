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

/// Ground's flight at its beginning: in the scenario as ground knows it, where its solution says that the vehicle is.
std::unique_ptr<Rehearsal> begin_ground_flight(const simulation::Scenario& scenario,
                                               const simulation::NavigationSolution& solution,
                                               const ClockCorrelation& clock, const dictionary::Dictionary& dictionary);

/// The true state of a flight of ground's.
NavigatedState state_of(const simulation::Landing& landing);

/// What leads from one state to another, the rotation in B after the attitude of the first.
flight::NavigationShift shift_to(const NavigatedState& from, const NavigatedState& to);

/// How well the state of the vehicle is known by a state that it told; none: by ground's solution alone.
simulation::StateKnowledge knowledge_by(const HeardFlight& heard, std::optional<Sclk> told,
                                        const simulation::Scenario& scenario);

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
