// SPDX-License-Identifier: Apache-2.0
#include "simulation/vehicle/rover_wheels.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::simulation {
namespace {

constexpr double weight_mps2 = 3.71;  // [facts]
constexpr double sinks_by_weight_m = 0.02;
constexpr double friction = 0.6, full_friction_from_mps = 0.03;

}  // namespace

Vector3 ground_reaction_N(double rover_kg, double sunk_m, const Vector3& normal, const Vector3& v) {
    if (sunk_m <= 0.0) return Vector3::Zero();
    const double stiffness_Npm = rover_kg * weight_mps2 / sinks_by_weight_m;
    const double damping_Nspm = 2.0 * std::sqrt(rover_kg * stiffness_Npm);
    const double away_mps = v.dot(normal);
    const double push_N = std::max(0.0, stiffness_Npm * sunk_m - damping_Nspm * away_mps);
    const Vector3 slides = v - away_mps * normal;
    return push_N * (normal - friction / std::max(slides.norm(), full_friction_from_mps) * slides);
}

}  // namespace aeolis::simulation
