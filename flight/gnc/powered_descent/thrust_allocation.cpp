// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/powered_descent/thrust_allocation.hpp"

#include "common/check.hpp"
#include "flight/devices/effectors.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace aeolis::flight::gnc::powered_descent {
namespace {

/// Thrust changes per torque: the torque columns of the pseudo-inverse of the running engines' torques and sum.
template <int n>
Eigen::Matrix<double, n, 3> changes_by_torque() {
    constexpr auto engines = descent_engines();
    Eigen::Matrix<double, 4, n> effect;
    for (int i = 0; i < n; ++i) {
        const Effector& engine = engines[static_cast<std::size_t>(n == 4 ? 2 * i : i)];
        effect.template block<3, 1>(0, i) = to_vector(engine.position_B_m).cross(to_vector(engine.direction_B));
        effect(3, i) = 1.0;
    }
    const Eigen::Matrix4d square = effect * effect.transpose();
    AEOLIS_CHECK(square.determinant() > 0.0);  // the running engines turn the vehicle about every axis
    return (effect.transpose() * square.inverse()).template leftCols<3>();
}

}  // namespace

TorqueAllocation::TorqueAllocation() : of_eight_(changes_by_torque<8>()), of_four_(changes_by_torque<4>()) {}

void TorqueAllocation::add(const Parameters& parameters, const Vector3& torque_B_Nm, int engines,
                           double engine_max_thrust_N, std::array<double, 8>& throttle) const {
    AEOLIS_CHECK((engines == 4 || engines == 8) && engine_max_thrust_N > 0.0);
    const double engine_used_min_N = parameters.engine_used_min_N, engine_used_max_N = parameters.engine_used_max_N;
    Eigen::Matrix<double, 8, 1> change_N = Eigen::Matrix<double, 8, 1>::Zero();
    if (engines == 4)
        for (Eigen::Index i = 0; i < 4; ++i) change_N[2 * i] = of_four_.row(i).dot(torque_B_Nm);
    else
        change_N = of_eight_ * torque_B_Nm;
    // Attitude has priority over thrust: with a wrong attitude, thrust pushes the wrong way. Where an engine would
    // leave its range, the common throttle moves until the torque has room; only a torque beyond the whole range is
    // reduced.
    const double most_N = change_N.maxCoeff(), least_N = change_N.minCoeff();
    const double part = std::min(1.0, (engine_used_max_N - engine_used_min_N) / std::max(most_N - least_N, 1.0));
    double each_N = throttle[0] * engine_max_thrust_N;
    // A torque that takes the whole range leaves one value, to which both ends round in their own way.
    const double lowest_N = engine_used_min_N - part * least_N;
    each_N = std::clamp(each_N, lowest_N, std::max(lowest_N, engine_used_max_N - part * most_N));
    const std::size_t stride = engines == 4 ? 2 : 1;
    for (std::size_t i = 0; i < throttle.size(); i += stride)
        throttle[i] = (each_N + part * change_N[static_cast<Eigen::Index>(i)]) / engine_max_thrust_N;
}

std::array<double, 8> throttles_for(const Parameters& parameters, double thrust_N, int engines,
                                    double engine_max_thrust_N, double& given_N) {
    AEOLIS_CHECK((engines == 4 || engines == 8) && engine_max_thrust_N > 0.0);
    const double each_N = std::clamp(thrust_N / engines, parameters.engine_used_min_N, parameters.engine_used_max_N);
    given_N = each_N * engines;
    std::array<double, 8> throttle{};
    const std::size_t stride = engines == 4 ? 2 : 1;
    for (std::size_t i = 0; i < throttle.size(); i += stride) throttle[i] = each_N / engine_max_thrust_N;
    return throttle;
}

Thrust allocate(const Parameters& parameters, const Vector3& specific_force_M, const Vector3& up_M, double mass_kg,
                int engines, double engine_max_thrust_N) {
    const double up = std::max(specific_force_M.dot(up_M), 0.0);
    const Vector3 level = specific_force_M - specific_force_M.dot(up_M) * up_M;
    // Lift has priority over sidestep: beyond the limit of tilt or thrust, the level part is reduced.
    const double most_level =
        std::min(std::tan(parameters.tilt_max_deg * degree) * up,
                 std::sqrt(std::max(std::pow(engines * parameters.engine_used_max_N / mass_kg, 2) - up * up, 0.0)));
    const double norm = level.norm();
    const Vector3 wanted = up * up_M + (norm > most_level ? Vector3(level * (most_level / norm)) : level);
    Thrust thrust;
    constexpr double no_thrust_mps2 = 1.0e-6;
    const double magnitude = wanted.norm();
    thrust.direction_M = magnitude > no_thrust_mps2 ? Vector3(wanted / magnitude) : up_M;
    thrust.throttle = throttles_for(parameters, magnitude * mass_kg, engines, engine_max_thrust_N, thrust.magnitude_N);
    return thrust;
}

}  // namespace aeolis::flight::gnc::powered_descent
