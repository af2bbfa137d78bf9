#include "simulation/vehicle/attitude.hpp"

#include "simulation/entry_flight.hpp"
#include "simulation/mars/mars.hpp"

#include <algorithm>

namespace aeolis::simulation {
namespace {

struct TurnLimits {
    double rate_rps, acceleration_rps2;
};
constexpr TurnLimits bank_limits{20.0 * degree_rad, 5.0 * degree_rad};     // [facts]
constexpr TurnLimits into_wind_limits{5.0 * degree_rad, 1.0 * degree_rad}; // ours
constexpr TurnLimits z_limits{40.0 * degree_rad, 80.0 * degree_rad};       // ours
constexpr double despin_rps2 = 0.5 * degree_rad;                           // ours
constexpr double weathervane_Pa = 20.0;                                    // ours
constexpr double trim_lag_s = 0.7;                                         // ours
constexpr double swing_rad = 5.0 * degree_rad;                             // ours, as the three below
constexpr double swing_period_s = 7.0;
constexpr double swing_decay_s = 12.0;

/// Turns `angle` toward zero within the limits: as fast as it can still be stopped.
void turn_to_zero(double& angle_rad, double& rate_rps, double step_s, const TurnLimits& limits) {
    const double distance_rad = std::abs(angle_rad);
    const double toward = angle_rad > 0.0 ? -1.0 : 1.0;
    const double stoppable_rps = std::sqrt(2.0 * 0.9 * limits.acceleration_rps2 * distance_rad);
    const double wanted_rps = toward * std::min({limits.rate_rps, stoppable_rps, 5.0 * distance_rad});
    const double most_change_rps = limits.acceleration_rps2 * step_s;
    rate_rps += std::clamp(wanted_rps - rate_rps, -most_change_rps, most_change_rps);
    angle_rad += rate_rps * step_s;
}

double wrapped(double angle_rad) {
    return std::remainder(angle_rad, 2.0 * std::numbers::pi);
}

} // namespace

Attitude::Attitude(const Quaternion& q_MB, double spin_rps, Random random)
    : q_MB_(q_MB), spin_rps_(spin_rps), swing_direction_rad_(2.0 * std::numbers::pi * random.uniform()) {}

Attitude::Kind Attitude::kind_for(const flight::AttitudeCommand& command, const Surroundings& next) const {
    using Mode = flight::AttitudeCommand::Mode;
    if (next.parachute_open) return Kind::hanging;
    if (!next.aeroshell) return command.mode == Mode::thrust ? Kind::thrusting : Kind::inertial;
    if (next.dynamic_pressure_Pa > weathervane_Pa) return Kind::wind;
    // A spinning body is not turned about another axis: the spin goes first.
    const bool turnable = next.thrusters && !next.spin_stabilised && spin_rps_ == 0.0;
    if (turnable && command.mode == Mode::entry_bank) return Kind::wind;
    return Kind::inertial;
}

void Attitude::advance(double step_s, const flight::AttitudeCommand& command, const Surroundings& next) {
    const Kind kind = kind_for(command, next);
    const bool entering = kind != kind_;
    kind_ = kind;
    switch (kind) {
    case Kind::inertial:
        keep_inertial(step_s, next);
        break;
    case Kind::wind:
        turn_with_wind(step_s, command, next, entering);
        break;
    case Kind::hanging: {
        if (entering) swing_age_s_ = z_rate_rps_ = 0.0;
        swing_age_s_ += step_s;
        const double angle_rad = swing_rad * std::exp(-swing_age_s_ / swing_decay_s) *
                                 std::sin(2.0 * std::numbers::pi * swing_age_s_ / swing_period_s);
        const Horizon local = horizon(next.p_MoB_M);
        const Vector3 sideways =
            std::cos(swing_direction_rad_) * local.east + std::sin(swing_direction_rad_) * local.north;
        turn_z_toward(next.v_AB_M.normalized() + std::tan(angle_rad) * sideways, step_s);
        break;
    }
    case Kind::thrusting: {
        if (entering) z_rate_rps_ = 0.0;
        const Vector3 wanted = -vector3(command.thrust_direction_M);
        if (wanted.allFinite() && wanted.squaredNorm() > 0.25) turn_z_toward(wanted, step_s);
        break;
    }
    }
}

void Attitude::keep_inertial(double step_s, const Surroundings& next) {
    if (!next.spin_stabilised && next.thrusters) {
        const double change_rps = std::min(std::abs(spin_rps_), despin_rps2 * step_s);
        spin_rps_ -= std::copysign(change_rps, spin_rps_);
    }
    const Quaternion mars_turns = rotation({0.0, 0.0, -mars_spin_rps * step_s});
    q_MB_ = (mars_turns * q_MB_ * rotation({0.0, 0.0, spin_rps_ * step_s})).normalized();
}

Quaternion Attitude::in_wind(const Surroundings& next) const {
    const Vector3 forward = next.v_AB_M.normalized();
    const Vector3 lift = lift_direction(next.p_MoB_M, next.v_AB_M, bank_rad_);
    const double cosine = std::cos(trim_rad_), sine = std::sin(trim_rad_);
    Eigen::Matrix3d R_MB;
    R_MB.col(0) = sine * forward + cosine * lift;
    R_MB.col(2) = cosine * forward - sine * lift;
    R_MB.col(1) = R_MB.col(2).cross(R_MB.col(0));
    return Quaternion{R_MB};
}

void Attitude::turn_with_wind(double step_s, const flight::AttitudeCommand& command, const Surroundings& next,
                              bool entering) {
    const bool asked = command.mode == flight::AttitudeCommand::Mode::entry_bank && std::isfinite(command.bank_rad);
    if (entering) {
        bank_rad_ = asked ? wrapped(command.bank_rad) : 0.0;
        bank_rate_rps_ = turn_rate_rps_ = 0.0;
        trim_rad_ = next.trim_angle_rad;
        const Vector3 turn_B = rotation_vector(in_wind(next).conjugate() * q_MB_);
        turn_rad_ = turn_B.norm();
        turn_axis_B_ = turn_rad_ > 0.0 ? Vector3{turn_B / turn_rad_} : Vector3::UnitX();
    }
    trim_rad_ += (next.trim_angle_rad - trim_rad_) * std::min(1.0, step_s / trim_lag_s);
    if (asked && next.thrusters) {
        double error_rad = wrapped(bank_rad_ - command.bank_rad);
        turn_to_zero(error_rad, bank_rate_rps_, step_s, bank_limits);
        bank_rad_ = wrapped(command.bank_rad + error_rad);
    } else {
        bank_rad_ = wrapped(bank_rad_ + bank_rate_rps_ * step_s);
    }
    // Pushed by the air it turns faster than by its thrusters.
    const bool by_air = next.dynamic_pressure_Pa > weathervane_Pa;
    if (turn_rad_ != 0.0) turn_to_zero(turn_rad_, turn_rate_rps_, step_s, by_air ? z_limits : into_wind_limits);
    q_MB_ = in_wind(next) * rotation(turn_rad_ * turn_axis_B_);
    q_MB_.normalize();
}

void Attitude::turn_z_toward(const Vector3& wanted_M, double step_s) {
    const Vector3 z = z_B_M();
    const Vector3 wanted = wanted_M.normalized();
    Vector3 axis = z.cross(wanted);
    const double sine = axis.norm();
    double error_rad = -std::atan2(sine, z.dot(wanted));
    const double before_rad = error_rad;
    turn_to_zero(error_rad, z_rate_rps_, step_s, z_limits);
    if (sine < 1e-9) return;
    q_MB_ = (rotation(axis * ((error_rad - before_rad) / sine)) * q_MB_).normalized();
}

} // namespace aeolis::simulation
