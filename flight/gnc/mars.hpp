// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/vector.hpp"

// Mars model of GNC: gravity, spin and speed of sound. Frame M turns with Mars, z along the spin.
namespace aeolis::flight::gnc {

inline constexpr double mars_gm_m3ps2 = 42828.3737e9;       ///< [facts] Mars
inline constexpr double mars_j2 = 1.9566e-3;                ///< [facts] Mars
inline constexpr double mars_equator_radius_m = 3396190.0;  ///< [facts] Mars
inline constexpr double mars_spin_rps = 7.088218e-5;        ///< [facts] Mars
inline constexpr double standard_gravity_mps2 = 9.80665;    ///< defines specific impulse
inline constexpr double mars_weight_mps2 = 3.71;            ///< g at Gale, [facts] Mars: only for bounds

/// Gravitational acceleration at the vehicle: point mass and oblateness (J2).
///
/// @param p_MoB_M  [m] 3×1, position of the vehicle from Mars's centre, in M; norm ≥ 3.0e6.
/// @return         [m/s²] 3×1, in M. Leaves out higher harmonics: about 2e-3 m/s² at the surface.
/// Source: [facts] for the constants, [vallado-2013] for the form.
Vector3 gravity(const Vector3& p_MoB_M);

/// Acceleration in free fall relative to rotating Mars.
/// gravity(p) − 2 ω × v − ω × (ω × p), ω the spin of Mars.
///
/// @param p_MoB_M  [m] 3×1 in M.   @param v_MB_M  [m/s] 3×1, relative to rotating Mars, in M.
/// @return         [m/s²] 3×1, in M.
Vector3 free_acceleration(const Vector3& p_MoB_M, const Vector3& v_MB_M);

/// By how much a vehicle takes gravity for stronger than `gravity`: that fraction of it on the ground, fading evenly to
/// none 100 km above the equator's radius, as a local departure does.
///
/// @param p_MoB_M  [m] 3×1 in M.   @return  [m/s²] 3×1, in M.
Vector3 local_gravity(const Vector3& p_MoB_M, double fraction);

/// Moves a vehicle that feels no force by one Runge-Kutta step of fourth order.
///
/// @param p_MoB_M  [m] 3×1 in M.   @param v_MB_M  [m/s] 3×1, relative to rotating Mars, in M.
/// @param dt_s     [s] of either sign, small against the radius over the speed.
void fall(Vector3& p_MoB_M, Vector3& v_MB_M, double dt_s);

/// Speed of sound [m/s] at a height above Gale's landing radius, −5 … 140 km; held outside.
/// For an estimate of the Mach number. From the temperature of [gale-atmosphere] with γ = 1.3 and R = 188.9 J/(kg
/// K); the piecewise linear form is our assumption.
double speed_of_sound_mps(double altitude_m);

}  // namespace aeolis::flight::gnc
