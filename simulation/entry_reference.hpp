// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/load.hpp"
#include "simulation/scenario.hpp"

// The reference of entry guidance: one undisturbed flight of the scenario's nominal entry, with range's derivatives.
//
// It flies in the simulation's own dynamics, under a bank profile chosen so that it ends at the target.
//
// Reference bank: by the corners of simulation/scenario.hpp, Guidance. The secant method on range finds the held bank.
// Only the vertical part of lift is flown: the sideways part is assumed to cancel between reversals.
//
// Partials: with velocity V as the independent variable, y = (height, flight path angle), dy/dV = F, ds/dV = G, u the
// vertical lift-to-drag, range to go R = ∫ G dV to the end of the reference:
//     λ = ∂R/∂y:   dλ/dV = −F_yᵀ λ − G_y        μ = ∂R/∂u:   dμ/dV = −(λᵀ F_u + G_u)
//     λ at the end from the descent, μ nil
//     ∂R/∂D = λ_h / (∂D/∂h)       ∂R/∂ḣ = λ_γ / (V cos γ)       ∂R/∂(L/D) = μ
// Source: [apollo-entry-guidance] for the tables and their use, [bryson-1975] for the adjoint.
namespace aeolis::simulation {

/// Computes the reference. Rows ascend in velocity from the start of SUFR to where the vehicle begins to slow down. For
/// a target out of reach the bank with the nearest end is used. Takes about 15 ms.
flight::EntryReference make_entry_reference(const Scenario& scenario);

/// The reference's bank [rad] at a velocity; `held_rad` is the bank that was found. For tests and reports.
double reference_bank_rad(const Scenario& scenario, double velocity_mps, double held_rad);

}  // namespace aeolis::simulation
