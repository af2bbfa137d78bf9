// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/powered_descent/divert.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::flight::gnc::powered_descent {

// NOLINTBEGIN(readability-magic-numbers): the coefficients of a quintic and its derivatives
void Divert::start(const Vector3& displacement_M, const Vector3& v0_M, double duration_s) {
    duration_s_ = std::max(duration_s, 1.0);
    const double T = duration_s_;
    v0_ = v0_M;
    // The cubic, quartic and quintic terms that meet the three conditions at T, after v0 T is subtracted.
    const Vector3 left = displacement_M - 0.5 * v0_M * T;
    const Vector3 speed = -v0_M * T;
    c3_ = (10.0 * left - 4.0 * speed) / (T * T * T);
    c4_ = (-15.0 * left + 7.0 * speed) / (T * T * T * T);
    c5_ = (6.0 * left - 3.0 * speed) / (T * T * T * T * T);
}

Vector3 Divert::position_M(double t_s) const {
    const double t = std::clamp(t_s, 0.0, duration_s_);
    return t * (v0_ + t * t * (c3_ + t * (c4_ + t * c5_)));
}

Vector3 Divert::velocity_M(double t_s) const {
    const double t = std::clamp(t_s, 0.0, duration_s_);
    return v0_ + t * t * (3.0 * c3_ + t * (4.0 * c4_ + t * 5.0 * c5_));
}

Vector3 Divert::acceleration_M(double t_s) const {
    if (t_s <= 0.0 || t_s >= duration_s_) return Vector3::Zero();
    const double t = t_s;
    return t * (6.0 * c3_ + t * (12.0 * c4_ + t * 20.0 * c5_));
}
// NOLINTEND(readability-magic-numbers)

Vector3 Divert::command_M(const Parameters& parameters, double t_s, const Vector3& x_M, const Vector3& v_M) const {
    return acceleration_M(t_s) + parameters.divert_velocity_gain_per_s * (velocity_M(t_s) - v_M) +
           parameters.divert_position_gain_per_s2 * (position_M(t_s) - x_M);
}

Sidestep choose_sidestep(const Parameters& parameters, const Vector3& divert_M, const Vector3& v0_M,
                         const std::optional<Vector3>& wind_M, double duration_s) {
    const Vector3 drift_M = wind_M.value_or(v0_M);
    const Vector3 backshell_M = (drift_M - 0.5 * v0_M) * duration_s;  // from where the stage's drift ends, at the end
    const double drift2 = drift_M.squaredNorm();
    const auto nearest_m = [&](const Vector3& end_M) {
        const Vector3 apart_M = end_M - backshell_M;
        const double nearest_s =
            drift2 > 0.0 ? std::clamp(apart_M.dot(drift_M) / drift2, 0.0, parameters.divert_clearance_for_s) : 0.0;
        return (apart_M - nearest_s * drift_M).norm();
    };
    const double planned_m = nearest_m(divert_M);
    const double opposite_m = nearest_m(-divert_M);
    const bool clear = planned_m >= parameters.divert_clearance_min_m;
    const bool planned = clear || planned_m >= opposite_m;
    Sidestep chosen{planned ? divert_M : Vector3{-divert_M}, {}};
    chosen.conditions.push_back(is(Quantity::sidestep_as_planned, planned, planned));
    chosen.conditions.push_back(
        clear ? at_least(Quantity::backshell_nearest_m, planned_m, parameters.divert_clearance_min_m)
              : below(Quantity::backshell_nearest_m, planned_m, parameters.divert_clearance_min_m));
    if (!clear)
        chosen.conditions.push_back(planned ? at_most(Quantity::backshell_nearest_opposite_m, opposite_m, planned_m)
                                            : above(Quantity::backshell_nearest_opposite_m, opposite_m, planned_m));
    chosen.conditions.push_back(is(Quantity::wind_known, wind_M.has_value(), wind_M.has_value()));
    return chosen;
}

Vector3 azimuth_direction(const Vector3& p_MoB_M, double azimuth_rad) {
    const auto [east_M, north_M] = level_axes(p_MoB_M.normalized());
    return std::cos(azimuth_rad) * north_M + std::sin(azimuth_rad) * east_M;
}

}  // namespace aeolis::flight::gnc::powered_descent
