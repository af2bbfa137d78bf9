// SPDX-License-Identifier: Apache-2.0
#include "simulation/vehicle/aeroshell.hpp"

#include "simulation/vectors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>

namespace aeolis::simulation {
namespace {

struct TrimRow {
    double mach, angle_deg;
};
/// Means over the published attitude, which oscillates by a degree or two. [od137]
constexpr std::array<TrimRow, 12> trim{{
    {2.0, 21.5},
    {2.25, 20.9},
    {2.5, 20.7},
    {3.0, 20.0},
    {4.0, 19.1},
    {5.0, 18.4},
    {6.0, 17.6},
    {8.0, 16.8},
    {10.0, 16.2},
    {12.0, 16.0},
    {15.0, 15.2},
    {27.0, 15.5},
}};

}  // namespace

AeroCoefficients scaled(AeroCoefficients coefficients, std::span<const AeroScale> scale, double mach) {
    if (scale.empty()) return coefficients;
    const auto above = std::ranges::upper_bound(scale, mach, {}, &AeroScale::mach);
    const AeroScale& high = above == scale.end() ? scale.back() : *above;
    const AeroScale& low = above == scale.begin() ? high : *std::prev(above);
    const double part = high.mach > low.mach ? (mach - low.mach) / (high.mach - low.mach) : 0.0;
    coefficients.drag *= std::lerp(low.drag, high.drag, part);
    coefficients.lift *= std::lerp(low.lift, high.lift, part);
    return coefficients;
}

double trim_angle_rad(double mach) {
    if (mach <= trim.front().mach) return degree_rad * trim.front().angle_deg;
    if (mach >= trim.back().mach) return degree_rad * trim.back().angle_deg;
    std::size_t above = 1;
    while (mach >= trim.at(above).mach) ++above;
    const TrimRow& low = trim.at(above - 1);
    const TrimRow& high = trim.at(above);
    const double part = (mach - low.mach) / (high.mach - low.mach);
    return degree_rad * (low.angle_deg + part * (high.angle_deg - low.angle_deg));
}

Trim trim_at(double mach) {
    constexpr double offset_m = 0.1;
    const double angle_rad = trim_angle_rad(mach);
    const double sine = std::sin(angle_rad);
    const AeroCoefficients coefficients = aeroshell_coefficients(mach, angle_rad);
    const double axial = coefficients.drag * std::cos(angle_rad) - coefficients.lift * sine;
    return {sine, axial * offset_m / (aeroshell_diameter_m * sine)};
}

}  // namespace aeolis::simulation
