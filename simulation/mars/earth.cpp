// SPDX-License-Identifier: Apache-2.0
#include "simulation/mars/earth.hpp"

namespace aeolis::simulation {
namespace {

// In the axes M at entry interface.
constexpr double earth_latitude_rad = 23.450 * degree_rad;
constexpr double earth_longitude_rad = 48.378 * degree_rad;
constexpr double mars_recedes_mps = 10450.0;
constexpr double highlands_m = 6130.0;  // (R + 8200 m) cos 2.0° − R, from the published set

}  // namespace

Vector3 earth_direction_M(double e_s) {
    return place(earth_latitude_rad, earth_longitude_rad - mars_spin_rps * e_s, 1.0);
}

double earth_elevation_rad(const Vector3& p, double e_s) {
    return std::asin(earth_direction_M(e_s).dot(p.normalized()));
}

bool earth_is_up(const Vector3& p, double e_s, double landing_radius_m) {
    const double radius_m = p.norm(), limb_m = landing_radius_m + highlands_m;
    const double sine = earth_direction_M(e_s).dot(p) / radius_m;
    if (sine >= 0.0 || radius_m <= limb_m) return sine >= 0.0;
    return sine * sine < 1.0 - limb_m * limb_m / (radius_m * radius_m);  // the limb's dip is acos(limb / radius)
}

double earth_range_rate_mps(const Vector3& p, const Vector3& v, double e_s) {
    return mars_recedes_mps - inertial_velocity(p, v).dot(earth_direction_M(e_s));
}

}  // namespace aeolis::simulation
