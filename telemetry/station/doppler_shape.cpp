// SPDX-License-Identifier: Apache-2.0
#include "telemetry/station/doppler_shape.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

namespace aeolis::telemetry {
namespace {

using Row = std::vector<double>;

double dot(const Row& one, const Row& other) {
    return std::inner_product(one.begin(), one.end(), other.begin(), 0.0);
}

/// Takes the part along `axis` off. @return how long it was, in lengths of `axis`
double take_off(Row& from, const Row& axis) {
    const double part = dot(from, axis) / dot(axis, axis);
    for (std::size_t i = 0; i < from.size(); ++i) from[i] -= part * axis[i];
    return part;
}

}  // namespace

std::optional<ShapeAmplitude> amplitude_of(const std::function<double(double)>& shape,
                                           std::span<const MeasuredPoint> points, int order, double shared) {
    const int unknowns = order + 2;
    const auto count = static_cast<int>(points.size());
    if (count <= unknowns) return {};
    const double first_s = points.front().time_s, length_s = points.back().time_s - first_s;
    if (length_s <= 0.0) return {};
    Row values, shaped;
    double variance = 0.0;
    for (const MeasuredPoint& point : points) {
        values.push_back(point.value);
        shaped.push_back(shape(point.time_s));
        variance += point.sigma * point.sigma / count;
    }
    const double whole = dot(shaped, shaped);
    std::vector<Row> axes;  // polynomials, each across the ones before
    for (int power = 0; power <= order; ++power) {
        Row axis;
        for (const MeasuredPoint& point : points)
            axis.push_back(std::pow(2.0 * (point.time_s - first_s) / length_s - 1.0, power));
        for (const Row& before : axes) take_off(axis, before);
        take_off(values, axis);
        take_off(shaped, axis);
        axes.push_back(std::move(axis));
    }
    constexpr double told_apart = 1.0e-6;  // of the shape's power, beyond rounding
    const double across = dot(shaped, shaped);
    if (across <= told_apart * whole) return {};
    const double amplitude = take_off(values, shaped);
    const double left = dot(values, values) / (count - unknowns);
    return ShapeAmplitude{amplitude, std::sqrt(shared * std::max(variance, left) / across)};
}

}  // namespace aeolis::telemetry
