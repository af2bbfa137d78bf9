// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace aeolis::simulation {

/// Static aerodynamics of the 70° sphere-cone entry vehicle.
///
/// Up to 16° of total angle of attack from the published table, bilinear, with 1.04 of its lift. Beyond 16°, where the
/// vehicle trims below Mach 10, the law is ours: drag goes on along its last slope, lift along six tenths of its last
/// slope. Both numbers give the lift-to-drag that the published trajectory flew at its trim angles (a test shows how
/// near). Up to 30°; lift falls off beyond.
struct AeroCoefficients {
    double drag = 0.0;
    double lift = 0.0;  ///< magnitude, always away from where the heatshield leans
};
AeroCoefficients aeroshell_coefficients(double mach, double angle_of_attack_rad);

inline constexpr double aeroshell_area_m2 = 15.9;  // [facts]: 4.5 m across

/// Where the air holds it with its balance masses on, and how hard.
struct Trim {
    double sine = 0.0;          ///< of trim_angle_rad
    double moment_slope = 0.0;  ///< C_mα [1/rad]
};
/// C_mα is the pitching moment by lean of the wind about the centre of mass, referred to area and diameter. From the
/// balance at trim, C_A · offset = C_mα · D · sin α_trim, with the centre of mass 0.1 m off the axis [facts] (L): so
/// trim angle and stiffness are one thing.
Trim trim_at(double mach);
/// Damping of pitch, yaw and roll by rate · D / 2V. Ours: small and positive at every Mach number.
inline constexpr double pitch_damping = 0.3;
inline constexpr double roll_damping = 0.03;
inline constexpr double aeroshell_diameter_m = 4.5;  // [facts]

/// Angle at which it flies by itself, from its offset centre of mass, before the balance masses go. [od137]
double trim_angle_rad(double mach);

/// The same after all balance masses are gone: the offset is nearly taken out. [od137] 2 to 3°
inline constexpr double balanced_trim_angle_rad = 2.5 * 0.017453292519943295;

}  // namespace aeolis::simulation
