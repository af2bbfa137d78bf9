// SPDX-License-Identifier: Apache-2.0
#include "simulation/vehicle/configuration.hpp"

#include <algorithm>
#include <array>
#include <bit>

namespace aeolis::simulation {

Configuration Configuration::at_entry(const Scenario& scenario) {
    Configuration configuration{scenario};
    configuration.cruise_stage = false;
    configuration.cruise_balances = 0;
    return configuration;
}

Configuration Configuration::at_powered_descent(const Scenario& scenario) {
    Configuration configuration = at_entry(scenario);
    configuration.entry_balance_pairs = 0;
    configuration.heatshield = configuration.backshell = false;
    return configuration;
}

void Configuration::weigh(const Masses& scenario, double factor) {
    const double burnt_kg = masses_.propellant_kg - propellant_kg_;
    const auto weighed = [factor](double kg) { return factor * kg; };
    auto parts = std::bit_cast<std::array<double, sizeof(Masses) / sizeof(double)>>(scenario);
    std::ranges::transform(parts, parts.begin(), weighed);
    masses_ = std::bit_cast<Masses>(parts);
    propellant_kg_ = std::max(0.0, masses_.propellant_kg - burnt_kg);
}

void Configuration::burn(double propellant_kg) {
    propellant_kg_ = std::max(0.0, propellant_kg_ - propellant_kg);
}

double Configuration::stage_kg() const {
    return masses_.powered_descent_kg - masses_.rover_kg - masses_.propellant_kg + propellant_kg_;
}

double Configuration::total_kg() const {
    double kg = stage_kg();
    if (bridle) kg += masses_.rover_kg;
    if (backshell) kg += masses_.backshell_and_parachute_kg + 2 * entry_balance_pairs * masses_.entry_balance_each_kg;
    if (heatshield) kg += masses_.heatshield_kg;
    kg += cruise_balances * masses_.cruise_balance_each_kg;
    if (cruise_stage) kg += masses_.cruise_stage_kg;
    return kg;
}

Vector3 Configuration::centre_B_m() const {
    const double entry_balances_kg = backshell ? 2 * entry_balance_pairs * masses_.entry_balance_each_kg : 0.0;
    const double cruise_balances_kg = cruise_balances * masses_.cruise_balance_each_kg;
    double along_kgm = stations_.balances_m * (entry_balances_kg + cruise_balances_kg);
    if (bridle && rover_on_stage) along_kgm += stations_.rover_m * masses_.rover_kg;
    if (backshell) along_kgm += stations_.backshell_m * masses_.backshell_and_parachute_kg;
    if (heatshield) along_kgm += stations_.heatshield_m * masses_.heatshield_kg;
    if (cruise_stage) along_kgm += stations_.cruise_stage_m * masses_.cruise_stage_kg;
    // Cruise balance masses sit opposite those that give the entry vehicle its lift.
    const double across_kgm = stations_.balances_off_axis_m * (entry_balances_kg - cruise_balances_kg);
    return Vector3{across_kgm, 0.0, along_kgm} / rigid_kg();
}

Inertia Configuration::inertia() const {
    const Gyration& g = gyration_;
    const auto [across_m, along_m] =
        cruise_stage     ? std::pair{g.with_cruise_stage_across_m, g.with_cruise_stage_along_m}
        : heatshield     ? std::pair{g.entry_vehicle_across_m, g.entry_vehicle_along_m}
        : backshell      ? std::pair{g.without_heatshield_across_m, g.without_heatshield_along_m}
        : rover_on_stage ? std::pair{g.stage_with_rover_across_m, g.stage_with_rover_along_m}
                         : std::pair{g.stage_across_m, g.stage_along_m};
    const double across = across_m * across_m, along = along_m * along_m;
    return {rigid_kg() * Vector3{across, across, along}};
}

double Configuration::offset() const {
    return (1.0 - 0.5 * cruise_balances) * entry_balance_pairs / 3.0;
}

}  // namespace aeolis::simulation
