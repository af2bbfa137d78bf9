#include "simulation/vehicle/configuration.hpp"

#include <algorithm>

namespace aeolis::simulation {

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

double Configuration::offset() const {
    return (1.0 - 0.5 * cruise_balances) * entry_balance_pairs / 3.0;
}

} // namespace aeolis::simulation
