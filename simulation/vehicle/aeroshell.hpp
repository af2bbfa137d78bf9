// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/aeroshell.hpp"
#include "simulation/scenario.hpp"

#include <span>

namespace aeolis::simulation {

/// The coefficients by the scenario's scale, if it has one.
AeroCoefficients scaled(AeroCoefficients coefficients, std::span<const AeroScale> scale, double mach);

/// The trim angle with all balance masses on, and the stiffness about it.
struct Trim {
    double sine = 0.0;          ///< of trim_angle_rad
    double moment_slope = 0.0;  ///< C_mα [1/rad]
};
/// C_mα is the slope of the pitching moment over the angle of the wind, about the centre of mass, by area and diameter.
/// It follows from the balance at trim, C_A · offset = C_mα · D · sin α_trim, with the centre of mass 0.1 m off the
/// axis [facts] (L): trim angle and stiffness determine each other.
Trim trim_at(double mach);
/// Damping of pitch, yaw and roll by rate · D / 2V. Our assumption: small and positive at every Mach number.
inline constexpr double pitch_damping = 0.3;
inline constexpr double roll_damping = 0.03;
inline constexpr double aeroshell_diameter_m = 4.5;  // [facts]

/// Trim angle from the offset centre of mass, before the balance masses are ejected. [od137]
double trim_angle_rad(double mach);

/// Trim angle after all balance masses are ejected: little of the offset is left. [od137] 2 to 3°
inline constexpr double balanced_trim_angle_rad = 2.5 * 0.017453292519943295;

}  // namespace aeolis::simulation
