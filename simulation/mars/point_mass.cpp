// SPDX-License-Identifier: Apache-2.0
#include "simulation/mars/point_mass.hpp"

namespace aeolis::simulation {

PointMass coast(PointMass from, double duration_s) {
    constexpr double longest_step_s = 1.0;
    const auto steps = static_cast<long>(std::ceil(std::abs(duration_s) / longest_step_s));
    const auto no_force = [](double, const Vector3&, const Vector3&) -> Vector3 { return Vector3::Zero(); };
    for (long i = 0; i < steps; ++i) from = runge_kutta_step(from, duration_s / static_cast<double>(steps), no_force);
    return from;
}

}  // namespace aeolis::simulation
