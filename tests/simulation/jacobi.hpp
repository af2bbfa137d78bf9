// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/mars/point_mass.hpp"

namespace aeolis::tests {

/// Energy in the rotating frame, which gravity with J2 keeps: kinetic, gravity's and the centrifugal potential.
/// (Jacobi)
inline double jacobi_m2ps2(const simulation::PointMass& at) {
    using namespace simulation;
    const Vector3& p = at.p_MoB_M;
    const double r = p.norm();
    const double sine2 = p.z() * p.z() / (r * r);
    const double oblate = 0.5 * mars_j2 * std::pow(mars_equatorial_radius_m / r, 2) * (3.0 * sine2 - 1.0);
    const double centrifugal = 0.5 * mars_spin_rps * mars_spin_rps * (p.x() * p.x() + p.y() * p.y());
    return 0.5 * at.v_MB_M.squaredNorm() - mars_gm_m3ps2 / r * (1.0 - oblate) - centrifugal;
}

}  // namespace aeolis::tests
