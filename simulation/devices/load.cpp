// SPDX-License-Identifier: Apache-2.0
#include "simulation/devices/load.hpp"

#include "simulation/entry_reference.hpp"

namespace aeolis::simulation {

flight::Load load_for(const Scenario& scenario) {
    flight::Load load;
    load.uhf_rate_bps = scenario.radio.uhf_rate_bps;
    load.telemetry_plan = scenario.telemetry_plan;
    load.entry_mass_kg = scenario.masses.entry_kg;
    load.powered_descent_mass_kg = scenario.masses.powered_descent_kg;
    load.descent_stage_dry_kg =
        scenario.masses.powered_descent_kg - scenario.masses.rover_kg - scenario.masses.propellant_kg;
    load.rover_mass_kg = scenario.masses.rover_kg;
    load.entry_reference = make_entry_reference(scenario);
    return load;
}

}  // namespace aeolis::simulation
