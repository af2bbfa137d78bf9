// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/mars.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace aeolis::flight::gnc {

Vector3 gravity(const Vector3& p_MoB_M) {
    const double r2 = p_MoB_M.squaredNorm();
    const double r = std::sqrt(r2);
    const double point_mass = -mars_gm_m3ps2 / (r2 * r);
    const double flattening = 1.5 * mars_j2 * mars_equator_radius_m * mars_equator_radius_m / r2;
    const double z2 = 5.0 * p_MoB_M.z() * p_MoB_M.z() / r2;
    const double in_equator = point_mass * (1.0 + flattening * (1.0 - z2));
    const double along_spin = point_mass * (1.0 + flattening * (3.0 - z2));
    return {in_equator * p_MoB_M.x(), in_equator * p_MoB_M.y(), along_spin * p_MoB_M.z()};
}

Vector3 free_acceleration(const Vector3& p_MoB_M, const Vector3& v_MB_M) {
    // With ω along z, both cross products have only two components.
    constexpr double w = mars_spin_rps;
    Vector3 a = gravity(p_MoB_M);
    a.x() += 2.0 * w * v_MB_M.y() + w * w * p_MoB_M.x();
    a.y() += -2.0 * w * v_MB_M.x() + w * w * p_MoB_M.y();
    return a;
}

Vector3 local_gravity(const Vector3& p_MoB_M, double fraction) {
    constexpr double local_gravity_ends_m = 100'000.0;  // our assumption
    const double part = 1.0 - (p_MoB_M.norm() - mars_equator_radius_m) / local_gravity_ends_m;
    return fraction * std::clamp(part, 0.0, 1.0) * gravity(p_MoB_M);
}

void fall(Vector3& p_MoB_M, Vector3& v_MB_M, double dt_s) {
    const Vector3 p = p_MoB_M, v = v_MB_M;
    const Vector3 a1 = free_acceleration(p, v);
    const Vector3 v2 = v + 0.5 * dt_s * a1, a2 = free_acceleration(p + 0.5 * dt_s * v, v2);
    const Vector3 v3 = v + 0.5 * dt_s * a2, a3 = free_acceleration(p + 0.5 * dt_s * v2, v3);
    const Vector3 v4 = v + dt_s * a3, a4 = free_acceleration(p + dt_s * v3, v4);
    const double sixth_s = dt_s / (1.0 + 2.0 + 2.0 + 1.0);  // Runge and Kutta's weights
    p_MoB_M = p + sixth_s * (v + 2.0 * v2 + 2.0 * v3 + v4);
    v_MB_M = v + sixth_s * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
}

double speed_of_sound_mps(double altitude_m) {
    struct Point {
        double altitude_m, temperature_K;
    };
    // Corners of the temperature profile, re-typed from [gale-atmosphere].
    static constexpr std::array<Point, 7> profile{{{0.0, 194.5},
                                                   {7353.0, 218.9},
                                                   {29412.0, 173.9},
                                                   {44118.0, 175.0},
                                                   {73529.0, 140.4},
                                                   {95588.0, 148.5},
                                                   {117647.0, 125.7}}};
    double temperature_K = profile.back().temperature_K;
    if (altitude_m <= profile.front().altitude_m) {
        temperature_K = profile.front().temperature_K;
    } else {
        for (std::size_t i = 1; i < profile.size(); ++i) {
            if (altitude_m >= profile[i].altitude_m) continue;
            const double part =
                (altitude_m - profile[i - 1].altitude_m) / (profile[i].altitude_m - profile[i - 1].altitude_m);
            temperature_K =
                profile[i - 1].temperature_K + part * (profile[i].temperature_K - profile[i - 1].temperature_K);
            break;
        }
    }
    constexpr double heat_ratio = 1.3, gas_J_per_kgK = 188.9;  // of carbon dioxide
    return std::sqrt(heat_ratio * gas_J_per_kgK * temperature_K);
}

}  // namespace aeolis::flight::gnc
