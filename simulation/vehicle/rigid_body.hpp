// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/mars/mars.hpp"

// A rigid body in flight around rotating Mars in six degrees of freedom.
//
//   ṗ = v    v̇ = F/m + gravity − 2 Ω×v − Ω×(Ω×p)    q̇_MB = ½ (q_MB ω − Ω q_MB)    I ω̇ = T − ω × Iω
//
// Frames   p, v, F in M, relative to rotating Mars; ω (relative to inertial space), T and I in B, about the centre of
//          mass
namespace aeolis::simulation {

struct RigidBody {
    Vector3 p_MoB_M = Vector3::Zero();  ///< [m]
    Vector3 v_MB_M = Vector3::Zero();   ///< [m/s]
    Quaternion q_MB = Quaternion::Identity();
    Vector3 rate_B_rps = Vector3::Zero();
};

/// Principal moments of inertia; the principal axes are those of B. [kg m²]
struct Inertia {
    Vector3 moments_B = Vector3::Ones();
};

/// Force and torque on a body. [N] in M, [N m] in B
struct Wrench {
    Vector3 force_M = Vector3::Zero();
    Vector3 torque_B = Vector3::Zero();
};

/// Time derivative of a rigid body's state, and the force that acts.
struct RigidBodySlope {
    Vector3 v, a;
    Eigen::Vector4d q;
    Vector3 rate;
    Vector3 force;
};

inline RigidBodySlope slope_of(const RigidBody& body, const Wrench& by, double mass_kg, const Inertia& inertia) {
    const Vector3& moments = inertia.moments_B;
    const Vector3& w = body.rate_B_rps;
    const Quaternion turning = body.q_MB * Quaternion{0.0, w.x(), w.y(), w.z()};
    const Quaternion under_it = Quaternion{0.0, 0.0, 0.0, mars_spin_rps} * body.q_MB;
    const Vector3 momentum = moments.cwiseProduct(w);
    return {body.v_MB_M, free_fall(body.p_MoB_M, body.v_MB_M) + by.force_M / mass_kg,
            0.5 * (turning.coeffs() - under_it.coeffs()), (by.torque_B - w.cross(momentum)).cwiseQuotient(moments),
            by.force_M};
}

/// The state after `time_s` at a constant slope, with the attitude normalised.
inline RigidBody moved(const RigidBody& at, const RigidBodySlope& by, double time_s) {
    RigidBody body;
    body.p_MoB_M = at.p_MoB_M + time_s * by.v;
    body.v_MB_M = at.v_MB_M + time_s * by.a;
    body.q_MB = Quaternion{Eigen::Vector4d{at.q_MB.coeffs() + time_s * by.q}}.normalized();
    body.rate_B_rps = at.rate_B_rps + time_s * by.rate;
    return body;
}

/// The Runge–Kutta mean of a step's four slopes.
inline RigidBodySlope mean_slope(const RigidBodySlope& k1, const RigidBodySlope& k2, const RigidBodySlope& k3,
                                 const RigidBodySlope& k4) {
    RigidBodySlope mean;
    mean.v = (k1.v + 2.0 * (k2.v + k3.v) + k4.v) / 6.0;
    mean.a = (k1.a + 2.0 * (k2.a + k3.a) + k4.a) / 6.0;
    mean.q = (k1.q + 2.0 * (k2.q + k3.q) + k4.q) / 6.0;
    mean.rate = (k1.rate + 2.0 * (k2.rate + k3.rate) + k4.rate) / 6.0;
    mean.force = (k1.force + 2.0 * (k2.force + k3.force) + k4.force) / 6.0;
    return mean;
}

/// One step of the classical fourth-order Runge–Kutta method over `step_s`; mass and inertia are constant over it.
///
/// `wrench(fraction, body)` is evaluated at that fraction of the step (0, 0.5, 1) with a unit attitude. `mean_force_M`,
/// when given, receives the mean force over the step by Simpson's rule, as an accelerometer measures it. Source:
/// [hairer-1993].
template <typename WrenchAt>
RigidBody runge_kutta_step(const RigidBody& at, double step_s, double mass_kg, const Inertia& inertia,
                           WrenchAt&& wrench, Vector3* mean_force_M = nullptr) {
    const auto slope = [&](double fraction, const RigidBody& body) {
        return slope_of(body, wrench(fraction, body), mass_kg, inertia);
    };
    const RigidBodySlope k1 = slope(0.0, at);
    const RigidBodySlope k2 = slope(0.5, moved(at, k1, 0.5 * step_s));
    const RigidBodySlope k3 = slope(0.5, moved(at, k2, 0.5 * step_s));
    const RigidBodySlope k4 = slope(1.0, moved(at, k3, step_s));
    const RigidBodySlope mean = mean_slope(k1, k2, k3, k4);
    if (mean_force_M != nullptr) *mean_force_M = mean.force;
    return moved(at, mean, step_s);
}

}  // namespace aeolis::simulation
