// SPDX-License-Identifier: Apache-2.0
#include "simulation/mars/mars.hpp"

namespace aeolis::simulation {

Vector3 gravity(const Vector3& p) {
    const double r2 = p.squaredNorm();
    const double r = std::sqrt(r2);
    const double z2_by_r2 = p.z() * p.z() / r2;
    const double j = 1.5 * mars_j2 * mars_equatorial_radius_m * mars_equatorial_radius_m / r2;
    const double k = -mars_gm_m3ps2 / (r2 * r);
    const double equatorial = k * (1.0 + j * (1.0 - 5.0 * z2_by_r2));
    return {equatorial * p.x(), equatorial * p.y(), k * (1.0 + j * (3.0 - 5.0 * z2_by_r2)) * p.z()};
}

Vector3 free_fall(const Vector3& p, const Vector3& v) {
    constexpr double w = mars_spin_rps;
    Vector3 a = gravity(p);
    a.x() += 2.0 * w * v.y() + w * w * p.x();
    a.y() += -2.0 * w * v.x() + w * w * p.y();
    return a;
}

Vector3 inertial_velocity(const Vector3& p, const Vector3& v) {
    return {v.x() - mars_spin_rps * p.y(), v.y() + mars_spin_rps * p.x(), v.z()};
}

Vector3 place(double latitude, double longitude, double radius_m) {
    return radius_m * Vector3{std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
                              std::sin(latitude)};
}

double latitude_rad(const Vector3& p) {
    return std::asin(p.z() / p.norm());
}

double longitude_rad(const Vector3& p) {
    return std::atan2(p.y(), p.x());
}

Horizon horizon(const Vector3& p) {
    Horizon at;
    at.up = p.normalized();
    at.east = Vector3{-p.y(), p.x(), 0.0}.normalized();
    at.north = at.up.cross(at.east);
    return at;
}

}  // namespace aeolis::simulation
