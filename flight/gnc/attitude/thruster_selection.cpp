// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/attitude/thruster_selection.hpp"

#include "common/check.hpp"
#include "common/time.hpp"
#include "flight/devices/effectors.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace aeolis::flight::gnc {
namespace {

constexpr std::size_t mounts = thruster_count / 2;

}  // namespace

ThrusterSelection::ThrusterSelection() {
    constexpr auto thrusters = entry_thrusters();
    Eigen::Matrix<double, 3, 4> torques;
    for (std::size_t mount = 0; mount < mounts; ++mount) {
        const Effector& even = thrusters[2 * mount];
        torques.col(static_cast<Eigen::Index>(mount)) = to_vector(even.position_B_m).cross(to_vector(even.direction_B));
    }
    const Matrix3 square = torques * torques.transpose();
    AEOLIS_CHECK(square.determinant() > 0.0);  // the mounts turn the vehicle about every axis
    forces_by_torque_ = torques.transpose() * square.inverse();
}

ThrusterCommand ThrusterSelection::select(const Vector3& torque_B_Nm) {
    ThrusterCommand command;
    if (torque_B_Nm.isZero()) {
        owed_s_.setZero();
        return command;
    }
    const Eigen::Vector4d forces_N = forces_by_torque_ * torque_B_Nm;
    const double full = std::max(forces_N.cwiseAbs().maxCoeff() / thruster_force_N, 1.0);
    owed_s_ += forces_N / (full * thruster_force_N) * seconds_per_tick;
    for (std::size_t mount = 0; mount < mounts; ++mount) {
        double& owed_s = owed_s_[static_cast<Eigen::Index>(mount)];
        if (std::abs(owed_s) < thruster_least_on_s) continue;
        const double on_s = std::min(std::abs(owed_s), seconds_per_tick);
        command.on_s[2 * mount + (owed_s > 0.0 ? 0 : 1)] = on_s;
        owed_s = std::clamp(owed_s - std::copysign(on_s, owed_s), -seconds_per_tick, seconds_per_tick);
    }
    return command;
}

}  // namespace aeolis::flight::gnc
