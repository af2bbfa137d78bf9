// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/scenario.hpp"

#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>

namespace aeolis::tests {

/// The scenario of the nominal landing as its text file has it, from `start_before_entry_s`.
inline simulation::Scenario gale_scenario(double start_before_entry_s = 700.0) {
    simulation::Scenario scenario;
    scenario.name = "gale";
    scenario.title = "as simulation/scenarios/nominal.textproto";
    scenario.entry_scet = {1344229847400000};
    scenario.start_before_entry_s = start_before_entry_s;
    std::ifstream file{AEOLIS_SOURCE_DIR "/simulation/scenarios/nominal.textproto"};
    simulation::DensityScale at;
    for (std::string line; std::getline(file, line);)
        if (std::sscanf(line.c_str(), "density_scale { altitude_m: %lf scale: %lf }", &at.altitude_m, &at.scale) == 2)
            scenario.density_scale.push_back(at);
    if (scenario.density_scale.size() <= 10)
        throw std::runtime_error{"nominal.textproto has no table of density_scale"};
    return scenario;
}

/// The same with every seeded error switched off.
inline simulation::Scenario undisturbed_scenario(double start_before_entry_s = 700.0) {
    return simulation::undispersed(gale_scenario(start_before_entry_s));
}

}  // namespace aeolis::tests
