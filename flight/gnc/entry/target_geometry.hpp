// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/vector.hpp"

// Geometry of the flight relative to its target, and of the lift, on a sphere that turns with Mars.
//
// Frame    M. Crossrange and bank are positive to the right of the velocity, downrange ahead.
// Source   [apollo-entry-guidance] for the quantities; sign of bank as in [od137]
// Valid    away from vertical flight (horizontal speed ≥ 1 m/s), not over the target's antipode
namespace aeolis::flight::gnc {

struct TargetGeometry {
    double range_to_go_m = 0.0;  ///< along the great circle to the target, at the target's radius
    double crossrange_m = 0.0;   ///< of the target from the plane of flight, positive to the right
    double downrange_m = 0.0;    ///< to the foot of the target on the plane of flight; negative once passed
};

/// @param target_M  unit, from Mars's centre to the target
TargetGeometry target_geometry(const Vector3& p_MoB_M, const Vector3& v_MB_M, const Vector3& target_M,
                               double target_radius_m);

/// Unit vector from Mars's centre to areocentric latitude, east longitude.
Vector3 direction_of(double latitude_rad, double longitude_rad);

/// Angle of the lift vector about the velocity: 0 up, positive to the right, −π … π.
/// A blunt body's lift points away from the side to which its heatshield (z of B) is tilted from the velocity.
double bank_of(const Quaternion& q_MB, const Vector3& p_MoB_M, const Vector3& v_MB_M);

/// Angle between z of B and the velocity [rad], 0 … π.
double angle_of_attack(const Quaternion& q_MB, const Vector3& v_MB_M);

}  // namespace aeolis::flight::gnc
