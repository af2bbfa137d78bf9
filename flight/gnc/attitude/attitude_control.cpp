// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/attitude/attitude_control.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::flight::gnc {
namespace {

TurnLimits bank_limits(const Parameters& parameters) {
    return {parameters.bank_rate_max_dps * degree, parameters.bank_acceleration_max_dps2 * degree,
            parameters.bank_deadband_deg * degree, parameters.bank_gain_per_s, parameters.turn_braking_fraction};
}

TurnLimits turn_limits(const Parameters& parameters) {
    return {parameters.turn_rate_max_dps * degree, parameters.turn_acceleration_max_dps2 * degree,
            parameters.turn_deadband_deg * degree, parameters.turn_gain_per_s, parameters.turn_braking_fraction};
}

TurnLimits tilt_limits(const Parameters& parameters) {
    return {parameters.tilt_rate_max_dps * degree, parameters.tilt_acceleration_max_dps2 * degree, 0.0,
            parameters.tilt_gain_per_s, parameters.turn_braking_fraction};
}

/// `v`, shortened to length `most` if longer.
Vector3 limited(const Vector3& v, double most) {
    const double norm = v.norm();
    return norm > most ? Vector3{v * (most / norm)} : v;
}

/// Acceleration that reduces the rate error to zero; zero within the deadband.
Vector3 towards(const Vector3& error_rps, double deadband_rps, double response_s, double most_rps2) {
    if (error_rps.norm() <= deadband_rps) return Vector3::Zero();
    return limited(error_rps / response_s, most_rps2);
}

/// Rotation vector of `q`, of length at most π.
Vector3 rotation_of(const Quaternion& q) {
    const double sign = q.w() < 0.0 ? -1.0 : 1.0;
    const double sine = q.vec().norm();
    constexpr double no_rotation = 1.0e-12;
    if (sine < no_rotation) return Vector3::Zero();
    return q.vec() * (sign * 2.0 * std::atan2(sine, std::abs(q.w())) / sine);
}

Vector3 lift_direction(double bank_rad, const Vector3& forward, const Vector3& p_MoB_M) {
    const Vector3 right = forward.cross(p_MoB_M).normalized();
    return std::cos(bank_rad) * right.cross(forward) + std::sin(bank_rad) * right;
}

/// Attitude at the nominal trim angle with the lift vector at `bank_rad`.
Quaternion trimmed(const Parameters& parameters, double bank_rad, const AttitudeState& state) {
    const double trim_rad = parameters.entry_trim_angle_deg * degree;
    const Vector3 forward = state.v_MB_M.normalized();
    const Vector3 lift = lift_direction(bank_rad, forward, state.p_MoB_M);
    Matrix3 R_MB;
    R_MB.col(0) = std::sin(trim_rad) * forward + std::cos(trim_rad) * lift;
    R_MB.col(2) = std::cos(trim_rad) * forward - std::sin(trim_rad) * lift;
    R_MB.col(1) = R_MB.col(2).cross(R_MB.col(0));
    return Quaternion{R_MB};
}

Vector3 turn(const Parameters& parameters, const Vector3& still_B, const Vector3& rate_B, const TurnLimits& limits) {
    const double angle_rad = still_B.norm();
    Vector3 wanted = Vector3::Zero();
    if (angle_rad > 0.0) wanted = still_B / angle_rad * rate_to_turn(angle_rad, limits);
    return towards(wanted - rate_B, parameters.rate_deadband_dps * degree, parameters.rate_response_s,
                   limits.acceleration_rps2);
}

Vector3 bank(const Parameters& parameters, const AttitudeCommand& command, const AttitudeState& state) {
    if (!state.in_air)
        return turn(parameters, rotation_of(state.q_MB.conjugate() * trimmed(parameters, command.bank_rad, state)),
                    state.rate_B_rps, turn_limits(parameters));
    const TurnLimits limits = bank_limits(parameters);
    const Vector3 forward_B = state.q_MB.conjugate() * state.v_MB_M.normalized();
    const double about_rps = state.rate_B_rps.dot(forward_B);
    const double wanted_rps = rate_to_turn(bank_error(command.bank_rad, state), limits);
    const Vector3 about = towards((wanted_rps - about_rps) * forward_B, parameters.rate_deadband_dps * degree,
                                  parameters.rate_response_s, limits.acceleration_rps2);
    const Vector3 across = state.rate_B_rps - about_rps * forward_B;
    return about + towards(-across, parameters.damping_deadband_dps * degree, parameters.rate_response_s,
                           limits.acceleration_rps2);
}

Vector3 acceleration(const Parameters& parameters, const AttitudeCommand& command, const AttitudeState& state) {
    using Mode = AttitudeCommand::Mode;
    switch (command.mode) {
    case Mode::idle: return Vector3::Zero();
    case Mode::detumble:
        return towards(-state.rate_B_rps, parameters.rate_deadband_dps * degree, parameters.rate_response_s,
                       parameters.detumble_acceleration_dps2 * degree);
    case Mode::entry_bank: return bank(parameters, command, state);
    case Mode::suspended:
        return towards(-state.rate_B_rps, parameters.suspended_deadband_dps * degree, parameters.rate_response_s,
                       bank_limits(parameters).acceleration_rps2);
    case Mode::thrust: {
        const TurnLimits limits = tilt_limits(parameters);
        const Vector3 wanted_B = state.q_MB.conjugate() * -to_vector(command.thrust_direction_M);
        const Vector3 axis = Vector3::UnitZ().cross(wanted_B);
        const double sine = axis.norm();
        const double angle_rad = std::atan2(sine, wanted_B.z());
        const Vector3 rate = sine > 1.0e-9 ? Vector3{axis / sine * rate_to_turn(angle_rad, limits)} : Vector3::Zero();
        return limited((rate - state.rate_B_rps) / parameters.tilt_response_s, limits.acceleration_rps2);
    }
    }
    return Vector3::Zero();
}

}  // namespace

double bank_error(double bank_rad, const AttitudeState& state) {
    const Vector3 forward = state.v_MB_M.normalized();
    const Vector3 right = forward.cross(state.p_MoB_M).normalized();
    const Vector3 x_M = state.q_MB * Vector3::UnitX();
    const double now_rad = std::atan2(x_M.dot(right), x_M.dot(right.cross(forward)));
    return std::remainder(bank_rad - now_rad, 2.0 * pi);
}

Vector3 control_torque(const Parameters& parameters, const AttitudeCommand& command, const AttitudeState& state,
                       const Inertia& inertia) {
    const Vector3 wanted_rps2 = acceleration(parameters, command, state);
    if (wanted_rps2.isZero()) return Vector3::Zero();
    return inertia.times(wanted_rps2) + state.rate_B_rps.cross(inertia.times(state.rate_B_rps));
}

}  // namespace aeolis::flight::gnc
