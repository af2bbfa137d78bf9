// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

namespace aeolis::server::campaign {

inline constexpr double km = 1.0e-3;  ///< multiplies metres to give kilometres

/// Running mean and standard deviation, without storing the numbers. Source: [welford-1962].
class Moments {
  public:
    void add(double value);
    std::uint64_t count() const { return count_; }
    double mean() const { return mean_; }
    double deviation() const;  ///< of the sample, by n − 1; 0 for fewer than two

  private:
    std::uint64_t count_ = 0;
    double mean_ = 0.0, squares_ = 0.0;
};

/// An ellipse about a mean, east and north.
struct Ellipse {
    double east_m = 0.0, north_m = 0.0;   ///< of its centre
    double major_m = 0.0, minor_m = 0.0;  ///< full axes
    double azimuth_deg = 0.0;             ///< of the major axis, from north to east, 0 … 180
};

/// Running moments of points in a plane, with an ellipse that holds 99 % of such a Gaussian. Its semi-axes are the
/// square roots of the covariance's eigenvalues times χ²(0.99; 2) = −2 ln 0.01 = 9.210.
class PlaneMoments {
  public:
    void add(double east_m, double north_m);
    std::uint64_t count() const { return count_; }
    Ellipse ellipse_99() const;  ///< of zero size for fewer than two points

  private:
    std::uint64_t count_ = 0;
    double east_m_ = 0.0, north_m_ = 0.0;
    double east_east_ = 0.0, east_north_ = 0.0, north_north_ = 0.0;
};

/// A percentile of numbers given in ascending order, which are not stored: the value below which `fraction` of them
/// lie, interpolated between neighbours. The first is at fraction 0, the last at 1 [hyndman-1996, type 7].
class Percentile {
  public:
    Percentile(double fraction, std::uint64_t count);
    void add(double value);  ///< not less than the one before
    double value() const { return value_; }

  private:
    double place_;
    std::uint64_t at_ = 0;
    double value_ = 0.0;
};

}  // namespace aeolis::server::campaign
