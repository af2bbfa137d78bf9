// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/scenario.hpp"
#include "simulation/vehicle/rigid_body.hpp"

namespace aeolis::simulation {

/// The attached parts, and so the mass and centre of mass of everything that flies on. Masses by the scenario. [facts]
///
/// Thrusters and engines draw on the same tanks, which lie about the stage's centre. Not modelled: the mortar's pack.
class Configuration {
  public:
    explicit Configuration(const Scenario& scenario)
        : masses_(scenario.masses), gyration_(scenario.gyration), stations_(scenario.stations),
          propellant_kg_(scenario.masses.propellant_kg) {}
    /// The configurations for which flight/devices/effectors.hpp gives positions: at entry, and when the engines take
    /// over.
    static Configuration at_entry(const Scenario& scenario);
    static Configuration at_powered_descent(const Scenario& scenario);

    /// Sets all masses to `factor` times the scenario's; jettisoned parts stay jettisoned.
    void weigh(const Masses& scenario, double factor);

    bool cruise_stage = true;
    int cruise_balances = 2;
    int entry_balance_pairs = 3;
    bool heatshield = true;
    bool backshell = true;       ///< with the parachute, stowed or open
    bool rover_on_stage = true;  ///< false: it hangs on the bridle
    bool bridle = true;          ///< false: cut

    double propellant_kg() const { return propellant_kg_; }
    void burn(double propellant_kg);
    void fill(double propellant_kg) { propellant_kg_ = propellant_kg; }

    const Masses& masses() const { return masses_; }
    const Stations& stations() const { return stations_; }
    double rover_kg() const { return masses_.rover_kg; }
    /// Mass of the descent stage alone with its present propellant.
    double stage_kg() const;
    /// Mass of all attached parts, including the rover while the bridle holds.
    double total_kg() const;
    /// Centre of mass of the rigid body, from the descent stage's own. [m] in B
    Vector3 centre_B_m() const;
    /// Mass and inertia of the rigid body about its centre of mass, without what hangs on the bridle. The attached
    /// parts give the radii of gyration.
    double rigid_kg() const { return total_kg() - (bridle && !rover_on_stage ? masses_.rover_kg : 0.0); }
    Inertia inertia() const;
    /// The fraction of the entry vehicle's centre-of-mass offset in force, 0 … 1. The cruise balance masses, until
    /// ejected, cancel the offset; ejecting the entry balance masses removes it.
    double offset() const;

  private:
    Masses masses_;
    Gyration gyration_;
    Stations stations_;
    double propellant_kg_;
};

}  // namespace aeolis::simulation
