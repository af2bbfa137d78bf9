// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/mars/atmosphere.hpp"
#include "simulation/mars/point_mass.hpp"
#include "simulation/scenario.hpp"

// Undisturbed flight of the entry vehicle under a given bank, integrated for the guidance reference.
namespace aeolis::simulation {

/// The scenario's nominal state at entry interface, without its delivery error.
PointMass nominal_entry(const Scenario& scenario);

/// Lift and drag [m/s²] of the aeroshell at its trim angle.
struct Sensed {
    double drag_mps2 = 0.0;
    double lift_mps2 = 0.0;
    double mach = 0.0;
};

/// The aeroshell in the scenario's nominal air (table × scale, no departure), without wind.
class EntryFlight {
  public:
    explicit EntryFlight(const Scenario& scenario);

    Sensed sensed(const PointMass& at) const;
    /// Specific force [m/s²] in M with the lift vector at `bank_rad`, positive to the right of the velocity.
    Vector3 specific_force(const PointMass& at, double bank_rad) const;
    PointMass step(const PointMass& at, double bank_rad, double step_s) const;
    double altitude_m(const PointMass& at) const { return at.p_MoB_M.norm() - landing_radius_m_; }

  private:
    Atmosphere atmosphere_;
    double landing_radius_m_;
    double mass_kg_;
    std::vector<AeroScale> aero_scale_;
};

/// Unit vector of lift for a velocity through the air and a bank angle about it; `p_MoB_M` gives the upward direction.
Vector3 lift_direction(const Vector3& p_MoB_M, const Vector3& v_AB_M, double bank_rad);

}  // namespace aeolis::simulation
