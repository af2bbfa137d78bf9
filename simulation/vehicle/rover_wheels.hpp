// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/vectors.hpp"

namespace aeolis::simulation {

/// Depth of the deployed wheels below the rover's centre of mass. Our assumption.
inline constexpr double wheels_below_rover_m = 0.6;

/// Force of the ground on the rover with its wheels `sunk_m` below the ground's plane. [N] in the arguments' frame.
///
/// Our assumptions: six wheels and soil act as one damped spring that yields 20 mm under the rover's weight and does
/// not bounce (critically damped, and never pulls); friction of 0.6 reaches its full value at 30 mm/s. The rover is a
/// point: it cannot tip.
Vector3 ground_reaction_N(double rover_kg, double sunk_m, const Vector3& normal, const Vector3& v);

}  // namespace aeolis::simulation
