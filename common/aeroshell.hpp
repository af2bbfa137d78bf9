// SPDX-License-Identifier: Apache-2.0
#pragma once

// Aerodynamics of the entry vehicle's shape, as the simulation flies it and as ground knows it. What a vehicle really
// has departs from it by an error that only the simulation knows.
namespace aeolis {

/// Static aerodynamics of the 70° sphere-cone entry vehicle.
///
/// Up to 16° of total angle of attack: the published table, bilinear, with 1.04 of its lift. Beyond 16°, where the
/// vehicle trims below Mach 10, our assumption: drag continues along its last slope, lift along six tenths of its last
/// slope. Both numbers give the lift-to-drag of the published trajectory at its trim angles (a test shows how closely).
/// Valid up to 30°; lift falls off beyond.
struct AeroCoefficients {
    double drag = 0.0;
    double lift = 0.0;  ///< magnitude; points away from the heatshield's lean
};
AeroCoefficients aeroshell_coefficients(double mach, double angle_of_attack_rad);

inline constexpr double aeroshell_area_m2 = 15.9;  // [facts]: 4.5 m across

}  // namespace aeolis
