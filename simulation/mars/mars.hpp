// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/vectors.hpp"

// Mars as a body: gravity, spin, positions on it. Everything in frame M, fixed to the rotating planet.
namespace aeolis::simulation {

inline constexpr double mars_gm_m3ps2 = 42828.3737e9;          // [konopliv-2016]
inline constexpr double mars_j2 = 1.9566e-3;                   // [konopliv-2016]
inline constexpr double mars_equatorial_radius_m = 3396190.0;  // [iau-mars]
inline constexpr double mars_spin_rps = 7.088218e-5;           // [iau-mars]

/// Gravitational acceleration: point mass and oblateness (J2). Leaves out higher harmonics, about 2e-3 m/s² at the
/// surface. `p_MoB_M` [m], norm above 3.0e6. Source: [konopliv-2016] constants, [vallado-2013] form.
Vector3 gravity(const Vector3& p_MoB_M);

/// Acceleration without other forces, relative to rotating Mars: gravity, Coriolis and centrifugal. [m/s²] in M.
Vector3 free_fall(const Vector3& p_MoB_M, const Vector3& v_MB_M);

/// Velocity relative to inertial space, in axes M. [m/s]
Vector3 inertial_velocity(const Vector3& p_MoB_M, const Vector3& v_MB_M);

/// Areocentric latitude, east longitude, radius → position in M. [rad, rad, m → m]
Vector3 place(double latitude_rad, double longitude_rad, double radius_m);
double latitude_rad(const Vector3& p_MoB_M);
double longitude_rad(const Vector3& p_MoB_M);

/// Unit vectors of the local horizon at `p_MoB_M`.
struct Horizon {
    Vector3 east, north, up;
};
Horizon horizon(const Vector3& p_MoB_M);

}  // namespace aeolis::simulation
