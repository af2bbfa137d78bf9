// SPDX-License-Identifier: Apache-2.0
#include "server/reconstruction/density.hpp"

#include "common/aeroshell.hpp"
#include "flight/gnc/mars.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace aeolis::reconstruction {
namespace {

double angle_between(const Vector3& a, const Vector3& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// One standard deviation of the drag coefficient, as a fraction: between the two Mach numbers in proportion.
double drag_sigma(double mach, const DensityErrors& errors) {
    constexpr double slow_below_mach = 3.0, fast_above_mach = 8.0;
    const double fast = std::clamp((mach - slow_below_mach) / (fast_above_mach - slow_below_mach), 0.0, 1.0);
    return std::lerp(errors.slow_drag_fraction, errors.fast_drag_fraction, fast);
}

double factor_at(const std::vector<KnownVehicle::DragScale>& rows, double mach) {
    if (rows.empty()) return 1.0;
    const auto above = std::ranges::upper_bound(rows, mach, {}, &KnownVehicle::DragScale::mach);
    if (above == rows.begin()) return rows.front().factor;
    if (above == rows.end()) return rows.back().factor;
    const auto below = std::prev(above);
    return std::lerp(below->factor, above->factor, (mach - below->mach) / (above->mach - below->mach));
}

}  // namespace

std::vector<DensityPoint> density_along(const Path& path, const RecordedLanding& recorded, const KnownVehicle& vehicle,
                                        const DensityErrors& errors) {
    const auto parachute = recorded.reported("PARACHUTE_DEPLOY");
    const auto gone = recorded.balance_pairs_gone();
    std::vector<DensityPoint> all;
    all.reserve(path.points.size());
    double mass_kg = vehicle.entry_mass_kg;
    auto next_gone = gone.begin();
    for (std::size_t i = 1; i < path.points.size(); ++i) {
        const PathPoint& before = path.points[i - 1];
        const PathPoint& now = path.points[i];
        if (parachute && now.at >= *parachute) break;  // it carries from then on
        for (; next_gone != gone.end() && *next_gone <= now.at; ++next_gone) mass_kg -= 2.0 * vehicle.balance_each_kg;
        if (now.at - before.at > 1.5 * path_step_s) continue;  // a gap
        const Vector3 v_M = 0.5 * (before.state.v_MB_M + now.state.v_MB_M);
        const double speed_mps = v_M.norm();
        const double drag_mps2 = -now.felt_M_mps2.dot(v_M) / speed_mps;
        const double height_m = 0.5 * (before.state.p_MoB_M.norm() + now.state.p_MoB_M.norm()) - path.target_radius_m;
        const double mach = speed_mps / flight::gnc::speed_of_sound_mps(height_m);
        if (!parachute && mach < errors.parachute_possible_mach) break;  // whether it is out nobody told
        const double attack_rad = angle_between(now.state.q_MB * Vector3::UnitZ(), v_M);
        const double shape = aeroshell_coefficients(mach, attack_rad).drag;
        const double drag = shape * factor_at(vehicle.drag_scale, mach);
        const double attack_sigma_rad = std::hypot(now.sigma_angle_rad.maxCoeff(), errors.wind_mps / speed_mps);
        const double by_attack = aeroshell_coefficients(mach, attack_rad + attack_sigma_rad).drag / shape - 1.0;
        const double speed_sigma_mps = std::hypot(now.sigma_v_mps.maxCoeff(), errors.wind_mps);
        const double sigma = std::hypot(std::hypot(drag_sigma(mach, errors), errors.mass_fraction, by_attack),
                                        2.0 * speed_sigma_mps / speed_mps, errors.felt_mps2 / std::abs(drag_mps2));
        if (drag_mps2 <= 0.0 || sigma > errors.sigma_fraction_max) continue;
        const double density_kgm3 = 2.0 * mass_kg * drag_mps2 / (drag * aeroshell_area_m2 * speed_mps * speed_mps);
        all.push_back({before.at + 0.5 * (now.at - before.at), height_m, density_kgm3, sigma * density_kgm3, mach});
    }
    return all;
}

}  // namespace aeolis::reconstruction
