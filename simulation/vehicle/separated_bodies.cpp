// SPDX-License-Identifier: Apache-2.0
#include "simulation/vehicle/separated_bodies.hpp"

#include "common/time.hpp"
#include "simulation/vehicle/parachute.hpp"

#include <algorithm>

namespace aeolis::simulation {
namespace {

constexpr double step_ticks = 4.0;

}  // namespace

void SeparatedBody::release(const PointMass& at, double mass_kg, double drag_area_m2,
                            const std::optional<ParachuteLift>& lift) {
    if (released_) return;
    released_ = true;
    at_ = at;
    mass_kg_ = mass_kg;
    drag_area_m2_ = drag_area_m2;
    lift_ = lift;
}

void SeparatedBody::tick(const Vector3& p_MoB_M, const std::optional<PointMass>& rover, const Atmosphere& atmosphere,
                         const Wind& wind, const Terrain& terrain) {
    if (!released_) return;
    since_release_s_ += seconds_per_tick;
    since_step_s_ += seconds_per_tick;
    if (since_step_s_ >= step_ticks * seconds_per_tick) {
        if (!down_) fly(since_step_s_, atmosphere, wind, terrain);
        since_step_s_ = 0.0;
    }
    const double before_m = distance_m_;
    distance_m_ = from(p_MoB_M).norm();
    if (rover) distance_m_ = std::min(distance_m_, from(rover->p_MoB_M).norm());
    clear_ = clear_ || distance_m_ >= clear_m_;
    if (clear_ && distance_m_ < before_m) least_m_ = std::min(least_m_.value_or(distance_m_), distance_m_);
}

void SeparatedBody::fly(double step_s, const Atmosphere& atmosphere, const Wind& wind, const Terrain& terrain) {
    const double start_s = since_release_s_ - step_s;
    at_ = runge_kutta_step(at_, step_s, [&](double fraction, const Vector3& p, const Vector3& v) -> Vector3 {
        const double altitude_m = terrain.altitude_m(p);
        const Vector3 through_air = v - wind.at(p, altitude_m);
        const double speed_mps = through_air.norm();
        if (speed_mps == 0.0) return Vector3::Zero();
        const Vector3 forward = through_air / speed_mps;
        Vector3 pull = -forward;
        if (lift_)
            pull += lift_->by_drag * parachute_lift_direction(forward, lift_->right_at_mortar_M,
                                                              lift_->since_mortar_s + start_s + fraction * step_s,
                                                              lift_->from_up_rad);
        return (0.5 * atmosphere.at(altitude_m).density_kgm3 * drag_area_m2_ / mass_kg_ * speed_mps * speed_mps) * pull;
    });
    if (terrain.height_m(at_.p_MoB_M) > 0.0) return;
    down_ = true;
    at_.p_MoB_M *= terrain.radius_m(at_.p_MoB_M) / at_.p_MoB_M.norm();
    at_.v_MB_M.setZero();
}

}  // namespace aeolis::simulation
