#pragma once

#include "simulation/scenario.hpp"

namespace aeolis::tests {

/// The scenario of the nominal landing as its text file has it, from `start_before_entry_s`.
inline simulation::Scenario gale_scenario(double start_before_entry_s = 700.0) {
    simulation::Scenario scenario;
    scenario.name = "gale";
    scenario.title = "as simulation/scenarios/nominal.textproto";
    scenario.entry_scet = {1344229847400000};
    scenario.start_before_entry_s = start_before_entry_s;
    scenario.density_scale = {{0, 0.98},     {2000, 0.985}, {3000, 1.02},  {4000, 1.05},  {5500, 1.09},
                              {7000, 1.13},  {9000, 1.12},  {10000, 1.09}, {11000, 1.03}, {12000, 0.94},
                              {14000, 0.92}, {15000, 0.9},  {17000, 0.9},  {18000, 0.95}, {21000, 0.95},
                              {26000, 1.02}, {34000, 1.1},  {45000, 1.1},  {58000, 0.85}};
    return scenario;
}

/// The same with every seeded error switched off.
inline simulation::Scenario undisturbed_scenario(double start_before_entry_s = 700.0) {
    return simulation::undispersed(gale_scenario(start_before_entry_s));
}

} // namespace aeolis::tests
