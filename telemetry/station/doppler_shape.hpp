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

/// Finds the amplitude of a shape in `points`, fitted by least squares together with a polynomial of the given order.
///
/// Its deviation follows from the deviations of the points or from the residuals of the fit, whichever are greater.
/// `shared` is the number of neighbouring points that have their noise in common. None when the points are too few, or
/// do not distinguish the shape from the polynomial.
std::optional<ShapeAmplitude> amplitude_of(const std::function<double(double)>& shape,
                                           std::span<const MeasuredPoint> points, int order, double shared);

}  // namespace aeolis::telemetry
