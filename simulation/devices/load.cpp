// SPDX-License-Identifier: Apache-2.0
#include "simulation/devices/load.hpp"

#include "simulation/entry_reference.hpp"

namespace aeolis::simulation {

flight::Load load_for(const Scenario& truth) {
    const Scenario scenario = as_believed(truth);
    flight::Load load;
    load.uhf_rate_bps = scenario.radio.uhf_rate_bps;
    load.telemetry_plan = scenario.telemetry_plan;
    load.entry_mass_kg = scenario.masses.entry_kg;
    load.powered_descent_mass_kg = scenario.masses.powered_descent_kg;
    load.descent_stage_dry_kg =
        scenario.masses.powered_descent_kg - scenario.masses.rover_kg - scenario.masses.propellant_kg;
    load.rover_mass_kg = scenario.masses.rover_kg;
    load.engine_max_thrust_N = scenario.engines.largest_thrust_N;
    load.engine_min_thrust_N = scenario.engines.least_thrust_N;
    load.engine_isp_s = scenario.guidance.engine_impulse_s;
    load.entry_lift_to_drag = scenario.guidance.entry_lift_to_drag;
    load.divert_m = scenario.guidance.divert_m;
    load.divert_azimuth_deg = scenario.guidance.divert_azimuth_deg;
    load.aim_east_m = scenario.guidance.aim_east_m;
    load.aim_north_m = scenario.guidance.aim_north_m;
    if (truth.believed) load.gravity_fraction = truth.believed->gravity_fraction;
    load.parameters = scenario.parameters;
    load.entry_reference = make_entry_reference(scenario);
    return load;
}

}  // namespace aeolis::simulation
