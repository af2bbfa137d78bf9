// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/mars/point_mass.hpp"
#include "simulation/vehicle/rigid_body.hpp"

// The sky crane: the descent stage, a rigid body, and the rover below it, a point that swings on the bridle. `loads`
// gives the forces between them. One step integrates both, so that momentum is kept to the integrator's order.
namespace aeolis::simulation {

struct StageAndRover {
    RigidBody stage;
    PointMass rover;
};

struct StageAndRoverLoads {
    Wrench on_stage;
    Vector3 on_rover_M = Vector3::Zero();  ///< [N]
};

/// One step of the classical fourth-order Runge–Kutta method, as of rigid_body.hpp; `loads(fraction, both)`.
template <typename LoadsAt>
StageAndRover runge_kutta_step(const StageAndRover& at, double step_s, double stage_kg, const Inertia& inertia,
                               double rover_kg, LoadsAt&& loads, Vector3* mean_force_M = nullptr) {
    struct Slope {
        RigidBodySlope stage;
        Vector3 v, a;
    };
    const auto slope = [&](double fraction, const StageAndRover& both) {
        const StageAndRoverLoads by = loads(fraction, both);
        const PointMass& rover = both.rover;
        return Slope{slope_of(both.stage, by.on_stage, stage_kg, inertia), rover.v_MB_M,
                     free_fall(rover.p_MoB_M, rover.v_MB_M) + by.on_rover_M / rover_kg};
    };
    const auto after = [&](const Slope& by, double time_s) {
        return StageAndRover{moved(at.stage, by.stage, time_s),
                             {at.rover.p_MoB_M + time_s * by.v, at.rover.v_MB_M + time_s * by.a}};
    };
    const Slope k1 = slope(0.0, at);
    const Slope k2 = slope(0.5, after(k1, 0.5 * step_s));
    const Slope k3 = slope(0.5, after(k2, 0.5 * step_s));
    const Slope k4 = slope(1.0, after(k3, step_s));
    const Slope mean{mean_slope(k1.stage, k2.stage, k3.stage, k4.stage), (k1.v + 2.0 * (k2.v + k3.v) + k4.v) / 6.0,
                     (k1.a + 2.0 * (k2.a + k3.a) + k4.a) / 6.0};
    if (mean_force_M != nullptr) *mean_force_M = mean.stage.force;
    return after(mean, step_s);
}

}  // namespace aeolis::simulation
