#include "simulation/vehicle/configuration.hpp"

#include "flight/devices/effectors.hpp"

#include <algorithm>

namespace aeolis::simulation {

Configuration Configuration::at_entry(const Masses& masses) {
    Configuration configuration{masses};
    configuration.cruise_stage = false;
    configuration.cruise_balances = 0;
    return configuration;
}

Configuration Configuration::at_powered_descent(const Masses& masses) {
    Configuration configuration = at_entry(masses);
    configuration.entry_balance_pairs = 0;
    configuration.heatshield = configuration.backshell = false;
    return configuration;
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
    double along_kgm = Stations::balances_m * (entry_balances_kg + cruise_balances_kg);
    if (bridle && rover_on_stage) along_kgm += Stations::rover_m * masses_.rover_kg;
    if (backshell) along_kgm += Stations::backshell_m * masses_.backshell_and_parachute_kg;
    if (heatshield) along_kgm += Stations::heatshield_m * masses_.heatshield_kg;
    if (cruise_stage) along_kgm += Stations::cruise_stage_m * masses_.cruise_stage_kg;
    // Cruise balance masses sit across from those that give the entry vehicle its lift.
    const double across_kgm = Stations::balances_off_axis_m * (entry_balances_kg - cruise_balances_kg);
    return Vector3{across_kgm, 0.0, along_kgm} / rigid_kg();
}

Inertia Configuration::inertia() const {
    const flight::Gyration& radii = cruise_stage      ? flight::gyration_with_cruise_stage
                                    : heatshield      ? flight::gyration_of_entry_vehicle
                                    : backshell       ? flight::gyration_without_heatshield
                                    : rover_on_stage  ? flight::gyration_of_stage_with_rover
                                                      : flight::gyration_of_stage;
    const double across = radii.across_m * radii.across_m, along = radii.along_z_m * radii.along_z_m;
    return {rigid_kg() * Vector3{across, across, along}};
}

double Configuration::offset() const {
    return (1.0 - 0.5 * cruise_balances) * entry_balance_pairs / 3.0;
}

} // namespace aeolis::simulation
