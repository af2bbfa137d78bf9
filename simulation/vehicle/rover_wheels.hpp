// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/vectors.hpp"

namespace aeolis::simulation {

/// The rover's wheels below its centre of mass, let down. Ours.
inline constexpr double wheels_below_rover_m = 0.6;

/// What the ground pushes the rover with, its wheels `sunk_m` below the ground's plane. [N] in the frame of its
/// arguments
///
/// Ours: six wheels and soil as one damped spring that gives 20 mm under the rover's weight and does not bounce
/// (critically damped, and never pulls), and friction of 0.6 that grows to its full value at 30 mm/s. The rover is a
/// point: it cannot tip.
Vector3 ground_reaction_N(double rover_kg, double sunk_m, const Vector3& normal, const Vector3& v);

}  // namespace aeolis::simulation
