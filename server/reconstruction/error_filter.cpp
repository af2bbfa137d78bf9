// SPDX-License-Identifier: Apache-2.0
#include "server/reconstruction/error_filter.hpp"

#include "flight/gnc/mars.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace aeolis::reconstruction {
namespace {

constexpr double range_noise_min_m = 0.1;  // chosen: from the rounding of numbers and times

Matrix3 cross(const Vector3& a) {
    Matrix3 m;
    m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
    return m;
}

/// Gradient of a point mass's gravity.
Matrix3 gravity_gradient(const Vector3& p_MoB_M) {
    const double radius_m = p_MoB_M.norm();
    const Vector3 up = p_MoB_M / radius_m;
    return flight::gnc::mars_gm_m3ps2 / (radius_m * radius_m * radius_m) *
           (3.0 * up * up.transpose() - Matrix3::Identity());
}

double squared(double value) {
    return value * value;
}

}  // namespace

ErrorFilter::ErrorFilter(const SensorErrors& errors, double accelerometer_bias_sigma_mps2, double target_radius_m)
    : errors_(errors), target_radius_m_(target_radius_m) {
    State sigma;
    sigma.segment<3>(p).setConstant(errors.position_m);
    sigma.segment<3>(v).setConstant(errors.velocity_mps);
    sigma.segment<3>(angle).setConstant(errors.attitude_rad);
    sigma.segment<3>(bias).setConstant(accelerometer_bias_sigma_mps2);
    sigma.segment<3>(scale).setConstant(errors.accelerometer_scale);
    sigma[range_scale] = errors.radar_range_fraction;
    sigma[ground] = errors.ground_height_m;
    sigma.segment<beams>(beam_bias).setConstant(errors.radar_velocity_mps);
    covariance_.diagonal() = sigma.cwiseAbs2();
}

ErrorFilter::Covariance ErrorFilter::transition(const Motion& motion) const {
    const double dt = motion.seconds;
    Covariance f = Covariance::Identity();
    const Matrix3 spin = cross({0.0, 0.0, flight::gnc::mars_spin_rps});
    const Matrix3 gradient = gravity_gradient(motion.p_MoB_M);
    const Matrix3 tilt = -cross(motion.sensed_M_mps);
    f.block<3, 3>(v, p) = dt * gradient;
    f.block<3, 3>(v, v) -= 2.0 * dt * spin;
    f.block<3, 3>(v, angle) = tilt;
    f.block<3, 3>(v, bias) = -motion.turned;
    f.block<3, 3>(v, scale) = -motion.turned_sensed;
    f.block<3, 3>(p, v) = dt * Matrix3::Identity();
    f.block<3, 3>(p, p) += 0.5 * dt * dt * gradient;
    for (const int cause : {angle, bias, scale}) f.block<3, 3>(p, cause) = 0.5 * dt * f.block<3, 3>(v, cause);
    f.block<3, 3>(angle, angle) -= dt * spin;
    return f;
}

void ErrorFilter::add_noise(const Motion& motion, bool sees_ground) {
    const double felt = squared(errors_.accelerometer_noise_mps) * motion.readings +
                        squared(errors_.unmodelled_mps_per_root_s) * motion.seconds;
    const double turned =
        squared(errors_.gyro_noise_rad) * motion.readings + squared(errors_.imu_misalignment_rad) * motion.turned_rad;
    covariance_.block<3, 3>(v, v) += felt * Matrix3::Identity();
    covariance_.block<3, 3>(angle, angle) += turned * Matrix3::Identity();
    if (sees_ground) covariance_(ground, ground) += squared(errors_.ground_relief_m) * motion.seconds;
}

void ErrorFilter::step(const Motion& motion, const std::vector<Sighting>& sightings, bool whole) {
    Step now;
    now.whole = whole;
    now.up_M = motion.p_MoB_M.normalized();
    now.transition = transition(motion);
    error_ = now.transition * error_;
    covariance_ = now.transition * covariance_ * now.transition.transpose();
    add_noise(motion, !sightings.empty());
    now.predicted = covariance_;
    now.predicted_error = error_;
    for (const Sighting& sighting : sightings) take(sighting);
    now.filtered = covariance_;
    now.filtered_error = error_;
    steps_.push_back(now);
}

void ErrorFilter::pass(const Gap& gap) {
    Step now;
    now.whole = false;
    Motion motion;
    motion.seconds = gap.seconds;
    motion.p_MoB_M = gap.p_MoB_M;
    motion.sensed_M_mps = gap.sensed_M_mps;
    now.transition = transition(motion);
    if (gap.radar) {
        covariance_.diagonal().segment<3>(p) += gap.p_M_m.cwiseAbs2();
        covariance_.diagonal().segment<3>(v) += gap.v_M_mps.cwiseAbs2();
        covariance_.diagonal().segment<3>(angle) += gap.angle_M_rad.cwiseAbs2();
    }
    error_.segment<3>(p) += gap.p_M_m;
    error_.segment<3>(v) += gap.v_M_mps;
    error_.segment<3>(angle) += gap.angle_M_rad;
    error_ = now.transition * error_;
    covariance_ = now.transition * covariance_ * now.transition.transpose();
    covariance_.block<3, 3>(p, p) += squared(gap.altitude_m) * Matrix3::Identity();
    covariance_.block<3, 3>(v, v) += squared(gap.velocity_mps) * Matrix3::Identity();
    covariance_.block<3, 3>(angle, angle) += squared(gap.attitude_rad) * Matrix3::Identity();
    attitude_considered_ = attitude_considered_ || gap.attitude_rad > 0.0;
    now.predicted = now.filtered = covariance_;
    now.predicted_error = now.filtered_error = error_;
    steps_.push_back(now);
}

// Each reading is compared with the path as corrected so far.
void ErrorFilter::take(const Sighting& sighting) {
    const int its_bias = beam_bias + sighting.beam;
    const auto corrected = [&](Vector3& p_M, Vector3& v_M, Vector3& d_M) {
        v_M = sighting.v_MB_M + error_.segment<3>(v);
        p_M = sighting.p_MoB_M + error_.segment<3>(p) - sighting.before_end_s * error_.segment<3>(v);
        const Vector3 turn = error_.segment<3>(angle);
        d_M = sighting.d_M + turn.cross(sighting.d_M) + 0.5 * turn.cross(turn.cross(sighting.d_M));
    };
    Vector3 p_M, v_M, d_M;
    corrected(p_M, v_M, d_M);
    State row = State::Zero();
    row.segment<3>(v) = -d_M;
    row.segment<3>(angle) = -d_M.cross(v_M);
    row[its_bias] = 1.0;
    observe(row, sighting.range_rate_mps - (error_[its_bias] - d_M.dot(v_M)), errors_.radar_velocity_mps);

    corrected(p_M, v_M, d_M);
    const double ground_radius_m = target_radius_m_ + error_[ground];
    const double along_m = p_M.dot(d_M);
    const double discriminant = squared(along_m) - (p_M.squaredNorm() - squared(ground_radius_m));
    if (discriminant <= 0.0) return;  // by the path it looks past Mars
    const double distance_m = -along_m - std::sqrt(discriminant);
    const Vector3 normal = (p_M + distance_m * d_M) / ground_radius_m;
    const double steep = normal.dot(d_M);
    row.setZero();
    row.segment<3>(p) = -normal / steep;
    row.segment<3>(v) = sighting.before_end_s / steep * normal;
    row.segment<3>(angle) = -distance_m / steep * d_M.cross(normal);
    row[ground] = 1.0 / steep;
    row[range_scale] = distance_m;
    observe(row, sighting.range_m - distance_m * (1.0 + error_[range_scale]),
            errors_.radar_range_fraction * distance_m + range_noise_min_m);
}

double ErrorFilter::end_at(const Vector3& off_M_m, double sigma_m) {
    double worst_sigmas = 0.0;
    for (int axis = 0; axis < 3; ++axis)
        worst_sigmas = std::max(worst_sigmas, std::abs(off_M_m[axis] - error_[p + axis]) /
                                                  std::sqrt(covariance_(p + axis, p + axis) + squared(sigma_m)));
    if (worst_sigmas > gate_sigmas) return worst_sigmas;
    for (int axis = 0; axis < 3; ++axis) {
        State row = State::Zero();
        row[p + axis] = 1.0;
        correct(row, off_M_m[axis] - error_[p + axis], sigma_m);
    }
    return worst_sigmas;
}

void ErrorFilter::observe(const State& row, double residual, double sigma) {
    const double variance = row.dot(covariance_ * row) + squared(sigma);
    if (squared(residual) > squared(gate_sigmas) * variance) {
        ++refused_;
        return;
    }
    ++taken_;
    correct(row, residual, sigma);
}

void ErrorFilter::correct(const State& row, double residual, double sigma) {
    const State seen = covariance_ * row;
    const double variance = row.dot(seen) + squared(sigma);
    State gain = seen / variance;
    if (attitude_considered_) gain.segment<3>(angle).setZero();
    error_ += residual * gain;
    covariance_ += variance * gain * gain.transpose() - gain * seen.transpose() - seen * gain.transpose();
}

std::vector<PathError> ErrorFilter::smoothed() const {
    std::vector<PathError> all;
    all.reserve(steps_.size());
    State error = error_;
    Covariance covariance = covariance_;
    for (std::size_t i = steps_.size(); i-- > 0;) {
        const Step& step = steps_[i];
        const State sigma = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
        if (step.whole)
            all.push_back({error.segment<3>(p), error.segment<3>(v), error.segment<3>(angle), sigma.segment<3>(p),
                           sigma.segment<3>(v), sigma.segment<3>(angle),
                           std::sqrt(std::max(step.up_M.dot(covariance.block<3, 3>(p, p) * step.up_M), 0.0))});
        if (i == 0) break;
        // Gain = filtered Fᵀ predicted⁻¹, with the states scaled to one: metres and radians differ by nine decades.
        const Step& before = steps_[i - 1];
        const State weight = step.predicted.diagonal().cwiseSqrt().cwiseInverse();
        const Covariance scaled = weight.asDiagonal() * step.predicted * weight.asDiagonal();
        const Covariance right = weight.asDiagonal() * (step.transition * before.filtered);
        const Covariance gain = (weight.asDiagonal() * scaled.ldlt().solve(right)).transpose();
        error = before.filtered_error + gain * (error - step.predicted_error);
        covariance = before.filtered + gain * (covariance - step.predicted) * gain.transpose();
    }
    std::ranges::reverse(all);
    return all;
}

}  // namespace aeolis::reconstruction
