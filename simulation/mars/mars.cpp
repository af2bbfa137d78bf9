// SPDX-License-Identifier: Apache-2.0
#include "simulation/mars/mars.hpp"

namespace aeolis::simulation {

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
