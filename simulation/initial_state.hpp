// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/draws.hpp"
#include "simulation/landing.hpp"
#include "simulation/mars/point_mass.hpp"
#include "simulation/scenario.hpp"

#include <cstdint>

namespace aeolis::simulation {

/// The vehicle's true state at the start, and ground's knowledge of it.
///
/// The scenario's entry state is taken at `entry_sclk`, disturbed by the delivery error, and propagated back in vacuum.
/// The delivery error moves the position along the surface (so entry stays at `entry_sclk`) and turns the flight path;
/// ground's solution departs from the truth by the knowledge error. A position or velocity deviation in the scenario is
/// that of the whole vector: each axis has 1/√3 of it (1/√2 for a delivery in two).
struct InitialState {
    PointMass truth;
    NavigationSolution solution;
    Sclk start;
    std::vector<Draw> draws;  ///< of delivery and knowledge; knowledge at entry, in M
};
InitialState initial_state(const Scenario& scenario, std::uint64_t seed, std::uint64_t case_number);
/// The same at a time other than the start, a multiple of 1/64 s before entry.
InitialState state_before_entry(const Scenario& scenario, double before_entry_s, std::uint64_t seed,
                                std::uint64_t case_number);

/// Attitude in late cruise: z of B points away from Earth, as the antenna of a spinning spacecraft needs. The angle to
/// the velocity agrees with the published one within a degree.
Quaternion cruise_attitude(double before_entry_s);

}  // namespace aeolis::simulation
