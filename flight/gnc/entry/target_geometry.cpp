// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/entry/target_geometry.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::flight::gnc {

TargetGeometry target_geometry(const Vector3& p_MoB_M, const Vector3& v_MB_M, const Vector3& target_M,
                               double target_radius_m) {
    const Vector3 up = p_MoB_M.normalized();
    const Vector3 left = up.cross(v_MB_M).normalized();  // unit normal of the plane of flight, to the left
    const Vector3 ahead = left.cross(up);
    const double above = target_M.dot(up);
    TargetGeometry geometry;
    // atan2 of sine and cosine: accurate near zero and near π, unlike acos.
    geometry.range_to_go_m = target_radius_m * std::atan2(up.cross(target_M).norm(), above);
    geometry.crossrange_m = -target_radius_m * std::asin(std::clamp(target_M.dot(left), -1.0, 1.0));
    geometry.downrange_m = target_radius_m * std::atan2(target_M.dot(ahead), above);
    return geometry;
}

Vector3 direction_of(double latitude_rad, double longitude_rad) {
    const double c = std::cos(latitude_rad);
    return {c * std::cos(longitude_rad), c * std::sin(longitude_rad), std::sin(latitude_rad)};
}

double bank_of(const Quaternion& q_MB, const Vector3& p_MoB_M, const Vector3& v_MB_M) {
    const Vector3 lean = q_MB * Vector3::UnitZ();
    const Vector3 right = v_MB_M.cross(p_MoB_M).normalized();
    const Vector3 lift_up = right.cross(v_MB_M).normalized();
    return std::atan2(-lean.dot(right), -lean.dot(lift_up));
}

double angle_of_attack(const Quaternion& q_MB, const Vector3& v_MB_M) {
    const Vector3 z = q_MB * Vector3::UnitZ();
    return std::atan2(z.cross(v_MB_M).norm(), z.dot(v_MB_M));
}

}  // namespace aeolis::flight::gnc
