// SPDX-License-Identifier: Apache-2.0
#include "common/mars_orientation.hpp"

#include <cmath>
#include <numbers>

namespace aeolis {
namespace {

constexpr double degree_rad = std::numbers::pi / 180.0;
constexpr double day_s = 86400.0, century_s = 36525.0 * day_s;
constexpr double spin_radps = mars_spin_degpday * degree_rad / day_s;

std::array<double, 3> times(const Matrix3& matrix, const std::array<double, 3>& vector) {
    std::array<double, 3> product{};
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 3; ++column)
            product.at(row) += matrix.at(row).at(column) * vector.at(column);
    return product;
}
Matrix3 transposed(const Matrix3& matrix) {
    Matrix3 result{};
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 3; ++column) result.at(column).at(row) = matrix.at(row).at(column);
    return result;
}

}  // namespace

Matrix3 mars_from_j2000(EphemerisTime time) {
    const double centuries = time.seconds / century_s, days = time.seconds / day_s;
    const double ascension = (317.68143 - 0.1061 * centuries) * degree_rad;
    const double declination = (52.88650 - 0.0609 * centuries) * degree_rad;
    const double meridian = std::fmod(176.630 + mars_spin_degpday * days, 360.0) * degree_rad;
    // About z by 90° + right ascension, about x by 90° - declination, about z by the prime meridian.
    const double a = std::numbers::pi / 2.0 + ascension, d = std::numbers::pi / 2.0 - declination;
    const double ca = std::cos(a), sa = std::sin(a), cd = std::cos(d), sd = std::sin(d);
    const double cw = std::cos(meridian), sw = std::sin(meridian);
    return {{{cw * ca - sw * cd * sa, cw * sa + sw * cd * ca, sw * sd},
             {-sw * ca - cw * cd * sa, -sw * sa + cw * cd * ca, cw * sd},
             {sd * sa, -sd * ca, cd}}};
}

PositionAndVelocity to_mars_fixed(const PositionAndVelocity& inertial, EphemerisTime time) {
    const Matrix3 matrix = mars_from_j2000(time);
    PositionAndVelocity fixed{times(matrix, inertial.position), times(matrix, inertial.velocity)};
    fixed.velocity[0] += spin_radps * fixed.position[1];
    fixed.velocity[1] -= spin_radps * fixed.position[0];
    return fixed;
}

PositionAndVelocity to_j2000(const PositionAndVelocity& mars_fixed, EphemerisTime time) {
    const Matrix3 matrix = transposed(mars_from_j2000(time));
    auto velocity = mars_fixed.velocity;
    velocity[0] -= spin_radps * mars_fixed.position[1];
    velocity[1] += spin_radps * mars_fixed.position[0];
    return {times(matrix, mars_fixed.position), times(matrix, velocity)};
}

}  // namespace aeolis
