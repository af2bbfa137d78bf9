// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/vectors.hpp"

#include <cmath>

// Mars as a body: gravity, spin, positions on it. Everything in frame M, fixed to the rotating planet.
namespace aeolis::simulation {

inline constexpr double mars_gm_m3ps2 = 42828.3737e9;          // [konopliv-2016]
inline constexpr double mars_j2 = 1.9566e-3;                   // [konopliv-2016]
inline constexpr double mars_equatorial_radius_m = 3396190.0;  // [iau-mars]
inline constexpr double mars_spin_rps = 7.088218e-5;           // [iau-mars]

/// Gravitational acceleration: point mass and oblateness (J2). Leaves out higher harmonics, about 2e-3 m/s² at the
/// surface. `p_MoB_M` [m], norm above 3.0e6. Source: [konopliv-2016] constants, [vallado-2013] form.
inline Vector3 gravity(const Vector3& p_MoB_M) {
    const Vector3& p = p_MoB_M;
    const double r2 = p.squaredNorm();
    const double r = std::sqrt(r2);
    const double z2_by_r2 = p.z() * p.z() / r2;
    const double j = 1.5 * mars_j2 * mars_equatorial_radius_m * mars_equatorial_radius_m / r2;
    const double k = -mars_gm_m3ps2 / (r2 * r);
    const double equatorial = k * (1.0 + j * (1.0 - 5.0 * z2_by_r2));
    return {equatorial * p.x(), equatorial * p.y(), k * (1.0 + j * (3.0 - 5.0 * z2_by_r2)) * p.z()};
}

/// Acceleration without other forces, relative to rotating Mars: gravity, Coriolis and centrifugal. [m/s²] in M.
inline Vector3 free_fall(const Vector3& p_MoB_M, const Vector3& v_MB_M) {
    constexpr double w = mars_spin_rps;
    Vector3 a = gravity(p_MoB_M);
    a.x() += 2.0 * w * v_MB_M.y() + w * w * p_MoB_M.x();
    a.y() += -2.0 * w * v_MB_M.x() + w * w * p_MoB_M.y();
    return a;
}

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
