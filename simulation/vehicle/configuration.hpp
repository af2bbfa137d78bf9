#pragma once

#include "simulation/scenario.hpp"
#include "simulation/vehicle/rigid_body.hpp"

namespace aeolis::simulation {

/// What is still attached, and so what all that flies on weighs. [facts] for the masses, by the scenario.
///
/// Not modelled: propellant of the entry thrusters (about 12 kg of 3153), the pack of the mortar.
class Configuration {
  public:
    explicit Configuration(const Masses& masses) : masses_(masses), propellant_kg_(masses.propellant_kg) {}

    bool cruise_stage = true;
    int cruise_balances = 2;
    int entry_balance_pairs = 3;
    bool heatshield = true;
    bool backshell = true;      ///< with the parachute in it or on it
    bool rover_on_stage = true; ///< else it hangs on the bridle
    bool bridle = true;         ///< else cut

    double propellant_kg() const { return propellant_kg_; }
    void burn(double propellant_kg);

    double rover_kg() const { return masses_.rover_kg; }
    /// The descent stage alone, as it is fuelled now.
    double stage_kg() const;
    /// All that is attached, the rover with it while the bridle holds.
    double total_kg() const;
    /// The rigid body's own, about its centre of mass: without what hangs on the bridle. Radii of gyration by what is attached
    /// (flight/devices/effectors.hpp); a jettison's shift of the centre of mass is left out.
    double rigid_kg() const { return total_kg() - (bridle && !rover_on_stage ? masses_.rover_kg : 0.0); }
    Inertia inertia() const;
    /// How much of the entry vehicle's offset of the centre of mass is in force, 0 … 1: the cruise balance masses keep
    /// it in until they go, the entry balance masses take it out as they go.
    double offset() const;

  private:
    Masses masses_;
    double propellant_kg_;
};

} // namespace aeolis::simulation
