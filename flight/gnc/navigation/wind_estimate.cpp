// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/navigation/wind_estimate.hpp"

#include "common/time.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::flight::gnc {
namespace {

/// Rows: east, north, up.
Matrix3 to_level(const Vector3& up_M) {
    const auto [east_M, north_M] = level_axes(up_M);
    Matrix3 axes;
    axes << east_M.transpose(), north_M.transpose(), up_M.transpose();
    return axes;
}

}  // namespace

void WindEstimate::on(const Parameters& parameters, const Vector3& up_M, const Vector3& v_M, const Vector3& force_M) {
    const Matrix3 axes = to_level(up_M);
    v_sum_ += axes * v_M;
    force_sum_ += axes * force_M;
    ++cycles_;
    if (cycles_ * seconds_per_tick < 1.0) return;  // longer than a swing below the parachute
    const Vector3 v = v_sum_ / cycles_;
    const Vector3 force = force_sum_ / cycles_;
    v_sum_.setZero();
    force_sum_.setZero();
    cycles_ = 0;
    if (force.z() <= 0.0 || force.head<2>().norm() > parameters.wind_slope_max * force.z()) return;

    const Level y = v.head<2>() - v.z() / force.z() * force.head<2>();
    const double r = y.squaredNorm();
    ++samples_;
    y_ += y;
    yy_ += y * y.transpose();
    yr_ += r * y;
    r_ += r;
    rr_ += r * r;
}

std::optional<Vector3> WindEstimate::wind_M(const Parameters& parameters, const Vector3& up_M) const {
    if (samples_ < parameters.wind_samples_min) return std::nullopt;
    const double n = samples_;
    const Level mean = y_ / n;
    const double r_mean = r_ / n;
    const Eigen::Matrix2d spread = yy_ / n - mean * mean.transpose();
    const double half_trace = 0.5 * spread.trace();
    const double least = half_trace - std::sqrt(std::max(half_trace * half_trace - spread.determinant(), 0.0));
    if (least <= 0.0) return std::nullopt;

    const Level with_r = yr_ / n - r_mean * mean;
    const Level wind = 0.5 * spread.inverse() * with_r;
    const double radius2 = r_mean - 2.0 * wind.dot(mean) + wind.squaredNorm();
    // In r a departure from the circle counts by twice the radius.
    const double departure2 = rr_ / n - r_mean * r_mean - 2.0 * wind.dot(with_r);
    const double departure_max = 2.0 * parameters.wind_departure_max * radius2;
    const bool shown = radius2 > 0.0 && least >= parameters.wind_spread_min * parameters.wind_spread_min * radius2 &&
                       departure2 <= departure_max * departure_max;
    if (!shown) return std::nullopt;
    return to_level(up_M).transpose() * Vector3{wind.x(), wind.y(), 0.0};
}

}  // namespace aeolis::flight::gnc
