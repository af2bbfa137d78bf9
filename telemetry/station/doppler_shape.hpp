// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>

namespace aeolis::telemetry {

struct MeasuredPoint {
    double time_s = 0.0, value = 0.0, sigma = 0.0;
};
struct ShapeAmplitude {
    double value = 0.0, sigma = 0.0;
};

/// The amplitude of a shape in `points`, beside a polynomial of the given order, by least squares.
///
/// Its deviation is that by the points' own or by what the fit leaves, whichever is more; `shared` neighbours have
/// their noise in common. None: the points are too few, or do not tell the shape from the polynomial.
std::optional<ShapeAmplitude> amplitude_of(const std::function<double(double)>& shape,
                                           std::span<const MeasuredPoint> points, int order, double shared);

}  // namespace aeolis::telemetry
