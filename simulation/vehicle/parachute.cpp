// SPDX-License-Identifier: Apache-2.0
#include "simulation/vehicle/parachute.hpp"

#include "simulation/mars/mars.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace aeolis::simulation {
namespace {

constexpr double overshoot = 0.2;           // our assumption
constexpr double overshoot_decay_s = 0.25;  // our assumption
constexpr double plane_turns_rps = 4.5 * 0.017453292519943295;

struct MachRow {
    double mach, factor;
};
// Our assumption: see the header.
constexpr std::array<MachRow, 8> factors{
    {{0.7, 1.0}, {0.85, 0.99}, {1.0, 0.92}, {1.1, 1.13}, {1.25, 1.24}, {1.6, 1.27}, {1.9, 1.22}, {2.5, 1.05}}};

}  // namespace

double parachute_inflation(double since_mortar_s) {
    if (since_mortar_s <= line_stretch_s) return 0.0;
    if (since_mortar_s < first_peak_s) {
        const double part = (since_mortar_s - line_stretch_s) / (first_peak_s - line_stretch_s);
        return (1.0 + overshoot) * part * part;
    }
    return 1.0 + overshoot * std::exp(-(since_mortar_s - first_peak_s) / overshoot_decay_s);
}

Vector3 level_right(const Vector3& p_MoB_M, const Vector3& v_MB_M) {
    const Vector3 right = v_MB_M.cross(p_MoB_M);
    const double least = 1e-9 * v_MB_M.norm() * p_MoB_M.norm();
    return right.norm() > least ? right.normalized() : Vector3{-horizon(p_MoB_M).north};
}

Vector3 parachute_lift_direction(const Vector3& forward, const Vector3& right_M, double since_mortar_s,
                                 double from_up_rad) {
    const double turned_rad = from_up_rad + plane_turns_rps * (since_mortar_s - line_stretch_s);
    const Vector3 right = (right_M - right_M.dot(forward) * forward).normalized();
    return std::cos(turned_rad) * right.cross(forward) + std::sin(turned_rad) * right;
}

double ParachuteOscillation::factor(double mach, double since_mortar_s) const {
    constexpr double swings_above_mach = 1.4, rate_rps = 4.0 * std::numbers::pi;
    return mach > swings_above_mach ? 1.0 + fraction * std::sin(rate_rps * since_mortar_s + phase_rad) : 1.0;
}

double parachute_mach_factor(double mach) {
    if (mach <= factors.front().mach) return factors.front().factor;
    for (std::size_t i = 1; i < factors.size(); ++i) {
        if (mach > factors[i].mach) continue;
        const double part = (mach - factors[i - 1].mach) / (factors[i].mach - factors[i - 1].mach);
        return factors[i - 1].factor + part * (factors[i].factor - factors[i - 1].factor);
    }
    return factors.back().factor;
}

}  // namespace aeolis::simulation
