// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>

// Vectors and rotations shared by the whole simulation. Frames: docs/frames_and_units.md.
namespace aeolis::simulation {

using Vector3 = Eigen::Vector3d;
using Quaternion = Eigen::Quaterniond;

inline constexpr double degree_rad = std::numbers::pi / 180.0;
inline constexpr double standard_gravity_mps2 = 9.80665;  // [bipm-si]

inline Vector3 vector3(const std::array<double, 3>& a) {
    return {a[0], a[1], a[2]};
}
inline std::array<double, 3> array3(const Vector3& v) {
    return {v.x(), v.y(), v.z()};
}
inline std::array<double, 4> array4(const Quaternion& q) {
    return {q.w(), q.x(), q.y(), q.z()};
}

/// The rotation by the vector `v`: its norm is the angle [rad], its direction the axis.
inline Quaternion rotation(const Vector3& v) {
    const double angle_rad = v.norm();
    // Below this the half angle is its own sine to the last bit.
    if (angle_rad < 1e-9) return Quaternion{1.0, 0.5 * v.x(), 0.5 * v.y(), 0.5 * v.z()};
    const Vector3 imaginary = v * (std::sin(0.5 * angle_rad) / angle_rad);
    return Quaternion{std::cos(0.5 * angle_rad), imaginary.x(), imaginary.y(), imaginary.z()};
}

/// The rotation vector of `q`: the inverse of rotation(), angle at most pi.
inline Vector3 rotation_vector(const Quaternion& q) {
    const double sign = q.w() < 0.0 ? -1.0 : 1.0;
    const double sine = q.vec().norm();
    if (sine < 1e-12) return 2.0 * sign * q.vec();
    return q.vec() * (sign * 2.0 * std::atan2(sine, sign * q.w()) / sine);
}

}  // namespace aeolis::simulation
