// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/mars/mars.hpp"

// Earth as seen from the landing, for the minutes around entry: a fixed direction in inertial space and one relative
// speed. Our fit to the published geometry (elevations within 0.01°, range rate within 12 m/s). [od137]
namespace aeolis::simulation {

/// Unit vector from Mars to Earth in M, `e_s` seconds from entry interface at the scenario's reference entry.
Vector3 earth_direction_M(double e_s);

/// Elevation of Earth above the local horizontal. [rad]
double earth_elevation_rad(const Vector3& p_MoB_M, double e_s);

/// Whether Earth stands above the terrain.
///
/// Where Earth sets lie highlands 6.13 km over the landing radius: Earth must be above their limb. A vehicle below that
/// height sees Earth only above the horizontal. The height is our assumption: it makes Earth set at the published −2.0°
/// for a vehicle at 8.2 km. [od137]
bool earth_is_up(const Vector3& p_MoB_M, double e_s, double landing_radius_m);

/// Rate of the vehicle's distance from Earth, positive when it grows. [m/s]
double earth_range_rate_mps(const Vector3& p_MoB_M, const Vector3& v_MB_M, double e_s);

}  // namespace aeolis::simulation
