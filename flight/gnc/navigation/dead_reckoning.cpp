// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/navigation/dead_reckoning.hpp"

#include "common/check.hpp"
#include "flight/gnc/mars.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::flight::gnc {

namespace {

Vector3 divided(const Vector3& torque_Nm, const Inertia& inertia) {
    return {torque_Nm.x() / inertia.across, torque_Nm.y() / inertia.across, torque_Nm.z() / inertia.along_z};
}

bool in_air(HeldBy held_by) {
    return held_by == HeldBy::air || held_by == HeldBy::new_trim;
}

double unknown_rate_rps(const Parameters& parameters, HeldBy held_by) {
    switch (held_by) {
    case HeldBy::nothing: return parameters.reckoned_rate_free_dps * degree;
    case HeldBy::air: return parameters.reckoned_rate_air_dps * degree;
    case HeldBy::new_trim: return parameters.reckoned_rate_trim_dps * degree;
    case HeldBy::parachute: return parameters.reckoned_rate_parachute_dps * degree;
    case HeldBy::engines: return parameters.reckoned_rate_engines_dps * degree;
    }
    return 0.0;
}

}  // namespace

ForceAndRate DeadReckoning::reckon(const Parameters& parameters, const Surroundings& now, const NavigatedState& state,
                                   const ForceAndRate& last, double dt_s) {
    AEOLIS_CHECK(dt_s > 0.0);
    if (silent_s_ == 0.0) {
        rate_B_rps_ = last.rate_B_rps;
        force_B_mps2_ = last.force_B_mps2;
        force_M_mps2_ = state.q_MB * last.force_B_mps2;
        speed_mps_ = std::max(state.v_MB_M.norm(), 1.0);
        altitude_m_ = now.altitude_m;
        thrust_N_ = now.thrust_N;
    }
    silent_s_ += dt_s;
    const Vector3 force = force_B(parameters, now, state);
    return {force, turn(parameters, now, state, force, dt_s)};
}

Vector3 DeadReckoning::force_B(const Parameters& parameters, const Surroundings& now,
                               const NavigatedState& state) const {
    if (now.held_by == HeldBy::nothing) return Vector3::Zero();
    if (now.held_by == HeldBy::engines) {
        if (thrust_N_ < parameters.engine_used_min_N) return {0.0, 0.0, -now.thrust_N / now.mass_kg};
        return force_B_mps2_ * (now.thrust_N / thrust_N_);
    }
    const double faster = state.v_MB_M.norm() / speed_mps_;
    const double denser = std::exp((altitude_m_ - now.altitude_m) / parameters.reckoned_scale_height_m);
    if (in_air(now.held_by)) return force_B_mps2_ * (faster * faster * denser);
    return state.q_MB.conjugate() * Vector3(force_M_mps2_ * (faster * faster * denser));
}

// The rate over the next step; what of it goes on is kept.
Vector3 DeadReckoning::turn(const Parameters& parameters, const Surroundings& now, const NavigatedState& state,
                            const Vector3& force_B_mps2, double dt_s) {
    if (in_air(now.held_by)) {
        const double speed_mps = std::max(state.v_MB_M.norm(), 1.0);
        const Vector3 forward_M = state.v_MB_M / speed_mps;
        const Vector3 forward_B = state.q_MB.conjugate() * forward_M;
        const double about_rps = (rate_B_rps_ + divided(now.torque_B_Nm, now.inertia) * dt_s).dot(forward_B);
        const Vector3 acceleration_M = state.q_MB * force_B_mps2 + now.free_M_mps2;
        const Vector3 with_velocity_M = forward_M.cross(acceleration_M) / speed_mps;
        rate_B_rps_ = about_rps * forward_B;
        return rate_B_rps_ + state.q_MB.conjugate() * (with_velocity_M + Vector3(0.0, 0.0, mars_spin_rps));
    }
    Vector3 torque_Nm = now.torque_B_Nm - rate_B_rps_.cross(now.inertia.times(rate_B_rps_));
    if (now.held_by == HeldBy::parachute)
        torque_Nm += Vector3(0.0, 0.0, -parameters.riser_arm_m).cross(Vector3(now.mass_kg * force_B_mps2)) -
                     parameters.wrist_damping_Nms * rate_B_rps_;
    rate_B_rps_ += divided(torque_Nm, now.inertia) * dt_s;
    return rate_B_rps_;
}

void Belief::pass(const Parameters& parameters, bool silent, HeldBy held_by, double force_mps2, double dt_s) {
    AEOLIS_CHECK(dt_s > 0.0);  // what is believed only widens
    if (silent) {
        attitude_rad_ += unknown_rate_rps(parameters, held_by) * dt_s;
        velocity_mps_ += parameters.reckoned_force_error * force_mps2 * dt_s;
    }
    velocity_mps_ += attitude_rad_ * force_mps2 * dt_s;
    altitude_m_ += velocity_mps_ * dt_s;
}

void Belief::hear_radar(double gain) {
    velocity_mps_ *= 1.0 - gain;
    altitude_m_ *= 1.0 - gain;
}

void Belief::narrow_attitude(const Parameters& parameters) {
    attitude_rad_ *= 1.0 - parameters.level_narrowing;
    if (attitude_rad_ < parameters.level_known_deg * degree) attitude_rad_ = 0.0;
}

}  // namespace aeolis::flight::gnc
