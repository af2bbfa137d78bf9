// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/scenario.hpp"
#include "simulation/vehicle/rigid_body.hpp"

namespace aeolis::simulation {

/// What is still attached, and so what all that flies on weighs, and where its centre of mass is. [facts] for the
/// masses, by the scenario. Thrusters and engines drink from the same tanks, which lie about the stage's centre.
///
/// Not modelled: the pack of the mortar.
class Configuration {
  public:
    explicit Configuration(const Scenario& scenario)
        : masses_(scenario.masses), gyration_(scenario.gyration), stations_(scenario.stations),
          propellant_kg_(scenario.masses.propellant_kg) {}
    /// As it enters, and as the engines take over: for these flight/devices/effectors.hpp has its drawings.
    static Configuration at_entry(const Scenario& scenario);
    static Configuration at_powered_descent(const Scenario& scenario);

    /// All parts weigh `factor` times the scenario's; what has gone stays gone.
    void weigh(const Masses& scenario, double factor);

    bool cruise_stage = true;
    int cruise_balances = 2;
    int entry_balance_pairs = 3;
    bool heatshield = true;
    bool backshell = true;       ///< with the parachute in it or on it
    bool rover_on_stage = true;  ///< else it hangs on the bridle
    bool bridle = true;          ///< else cut

    double propellant_kg() const { return propellant_kg_; }
    void burn(double propellant_kg);

    const Masses& masses() const { return masses_; }
    const Stations& stations() const { return stations_; }
    double rover_kg() const { return masses_.rover_kg; }
    /// The descent stage alone, as it is fuelled now.
    double stage_kg() const;
    /// All that is attached, the rover with it while the bridle holds.
    double total_kg() const;
    /// Centre of mass of the rigid body, from the descent stage's own. [m] in B
    Vector3 centre_B_m() const;
    /// The rigid body's own, about its centre of mass: without what hangs on the bridle. Radii of gyration by what is
    /// attached.
    double rigid_kg() const { return total_kg() - (bridle && !rover_on_stage ? masses_.rover_kg : 0.0); }
    Inertia inertia() const;
    /// How much of the entry vehicle's offset of the centre of mass is in force, 0 … 1: the cruise balance masses keep
    /// it in until they go, the entry balance masses take it out as they go.
    double offset() const;

  private:
    Masses masses_;
    Gyration gyration_;
    Stations stations_;
    double propellant_kg_;
};

}  // namespace aeolis::simulation
