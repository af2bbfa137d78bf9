// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace aeolis::server::campaign {
namespace {

const double chi_squared_99 = -2.0 * std::log(1.0 - 0.99);  // two degrees of freedom: closed form

}  // namespace

void Moments::add(double value) {
    ++count_;
    const double off = value - mean_;
    mean_ += off / static_cast<double>(count_);
    squares_ += off * (value - mean_);
}

double Moments::deviation() const {
    return count_ < 2 ? 0.0 : std::sqrt(squares_ / static_cast<double>(count_ - 1));
}

void PlaneMoments::add(double east_m, double north_m) {
    ++count_;
    const double n = static_cast<double>(count_);
    const double off_east = east_m - east_m_, off_north = north_m - north_m_;
    east_m_ += off_east / n;
    north_m_ += off_north / n;
    east_east_ += off_east * (east_m - east_m_);
    east_north_ += off_east * (north_m - north_m_);
    north_north_ += off_north * (north_m - north_m_);
}

Ellipse PlaneMoments::ellipse_99() const {
    Ellipse ellipse;
    ellipse.east_m = east_m_;
    ellipse.north_m = north_m_;
    if (count_ < 2) return ellipse;
    const double n = static_cast<double>(count_ - 1);
    const double a = east_east_ / n, b = east_north_ / n, c = north_north_ / n;
    const double middle = 0.5 * (a + c);
    const double half = std::hypot(0.5 * (a - c), b);
    ellipse.major_m = 2.0 * std::sqrt(chi_squared_99 * (middle + half));
    ellipse.minor_m = 2.0 * std::sqrt(chi_squared_99 * std::max(middle - half, 0.0));
    const double azimuth_rad = 0.5 * std::atan2(2.0 * b, c - a);
    ellipse.azimuth_deg = (azimuth_rad < 0.0 ? azimuth_rad + std::numbers::pi : azimuth_rad) * 180.0 / std::numbers::pi;
    return ellipse;
}

Percentile::Percentile(double fraction, std::uint64_t count)
    : place_(count == 0 ? 0.0 : fraction * static_cast<double>(count - 1)) {}

void Percentile::add(double value) {
    // Linear weights: only the two neighbours of place_ contribute.
    const double part = 1.0 - std::abs(static_cast<double>(at_) - place_);
    if (part > 0.0) value_ += part * value;
    ++at_;
}

}  // namespace aeolis::server::campaign
