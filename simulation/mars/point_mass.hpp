// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/mars/mars.hpp"

// A point mass in flight around rotating Mars, and its integration.
namespace aeolis::simulation {

/// Position from Mars's centre and velocity relative to rotating Mars, in M. [m, m/s]
struct PointMass {
    Vector3 p_MoB_M = Vector3::Zero();
    Vector3 v_MB_M = Vector3::Zero();
};

/// One step of the classical fourth-order Runge–Kutta method over `step_s` (negative: back in time).
///
/// `specific_force(fraction, p, v)` gives the specific force [m/s²] in M at that fraction of the step (0, 0.5, 1).
/// `mean_specific_force`, when given, receives the mean over the step by Simpson's rule, as an accelerometer measures
/// it. Source: [hairer-1993].
template <typename SpecificForce>
PointMass runge_kutta_step(const PointMass& at, double step_s, SpecificForce&& specific_force,
                           Vector3* mean_specific_force = nullptr) {
    const double half_s = 0.5 * step_s;
    const Vector3 f1 = specific_force(0.0, at.p_MoB_M, at.v_MB_M);
    const Vector3 a1 = free_fall(at.p_MoB_M, at.v_MB_M) + f1;
    const Vector3 p2 = at.p_MoB_M + half_s * at.v_MB_M;
    const Vector3 v2 = at.v_MB_M + half_s * a1;
    const Vector3 f2 = specific_force(0.5, p2, v2);
    const Vector3 a2 = free_fall(p2, v2) + f2;
    const Vector3 p3 = at.p_MoB_M + half_s * v2;
    const Vector3 v3 = at.v_MB_M + half_s * a2;
    const Vector3 f3 = specific_force(0.5, p3, v3);
    const Vector3 a3 = free_fall(p3, v3) + f3;
    const Vector3 p4 = at.p_MoB_M + step_s * v3;
    const Vector3 v4 = at.v_MB_M + step_s * a3;
    const Vector3 f4 = specific_force(1.0, p4, v4);
    const Vector3 a4 = free_fall(p4, v4) + f4;
    if (mean_specific_force != nullptr) *mean_specific_force = (f1 + 2.0 * (f2 + f3) + f4) / 6.0;
    const double sixth_s = step_s / 6.0;
    return {at.p_MoB_M + sixth_s * (at.v_MB_M + 2.0 * (v2 + v3) + v4),
            at.v_MB_M + sixth_s * (a1 + 2.0 * (a2 + a3) + a4)};
}

/// Propagates free fall over `duration_s` (negative: back in time) in steps of at most one second. The error stays
/// below a millimetre over an hour on an approach orbit.
PointMass coast(PointMass from, double duration_s);

}  // namespace aeolis::simulation
