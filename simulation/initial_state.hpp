// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/landing.hpp"
#include "simulation/mars/point_mass.hpp"
#include "simulation/scenario.hpp"

#include <cstdint>

namespace aeolis::simulation {

/// Where the vehicle truly is at the start, and what ground believes.
///
/// The scenario's entry state is taken at `entry_sclk`, there disturbed by the delivery error, and propagated back in
/// vacuum. The delivery error moves it along the surface (so entry stays at `entry_sclk`) and turns its flight path;
/// ground's solution departs from the truth by the knowledge error. A position or velocity deviation of the scenario is
/// that of the whole vector: each axis has 1/√3 of it (1/√2 of a delivery in two).
struct InitialState {
    PointMass truth;
    NavigationSolution solution;
    Sclk start;
};
InitialState initial_state(const Scenario& scenario, std::uint64_t seed, std::uint64_t case_number);
/// The same at another moment than the start, a multiple of 1/64 s.
InitialState state_before_entry(const Scenario& scenario, double before_entry_s, std::uint64_t seed,
                                std::uint64_t case_number);

/// Attitude in late cruise: z of B away from Earth, as the antenna of a spinning spacecraft needs it; it gives the
/// published angle to the velocity within a degree.
Quaternion cruise_attitude(double before_entry_s);

}  // namespace aeolis::simulation
