// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>

// Linear algebra types of GNC, and conversions from and to messages, which hold plain numbers.
namespace aeolis::flight::gnc {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using Quaternion = Eigen::Quaterniond;

inline Vector3 to_vector(const std::array<double, 3>& v) {
    return {v[0], v[1], v[2]};
}
inline std::array<double, 3> to_array(const Vector3& v) {
    return {v.x(), v.y(), v.z()};
}
inline Quaternion to_quaternion(const std::array<double, 4>& q) {
    return Quaternion(q[0], q[1], q[2], q[3]).normalized();
}
inline std::array<double, 4> to_array(const Quaternion& q) {
    return {q.w(), q.x(), q.y(), q.z()};
}

/// East and north where `up_M` points up, unit vectors in M. Not at the poles.
struct LevelAxes {
    Vector3 east_M, north_M;
};
inline LevelAxes level_axes(const Vector3& up_M) {
    const Vector3 east_M = Vector3::UnitZ().cross(up_M).normalized();
    return {east_M, up_M.cross(east_M)};
}

inline constexpr double pi = 3.14159265358979323846;
inline constexpr double degree = pi / 180.0;

}  // namespace aeolis::flight::gnc
