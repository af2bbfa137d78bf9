#include "flight/gnc/attitude/thruster_selection.hpp"

#include "common/time.hpp"
#include "flight/devices/effectors.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace aeolis::flight::gnc {
namespace {

constexpr std::size_t mounts = thruster_count / 2;

} // namespace

ThrusterSelection::ThrusterSelection() {
    constexpr auto thrusters = entry_thrusters();
    Eigen::Matrix<double, 3, 4> torques;
    for (std::size_t mount = 0; mount < mounts; ++mount) {
        const Effector& even = thrusters[2 * mount];
        torques.col(static_cast<Eigen::Index>(mount)) =
            to_vector(even.position_B_m).cross(to_vector(even.direction_B));
    }
    const Matrix3 square = torques * torques.transpose();
    forces_by_torque_ = torques.transpose() * square.inverse();
}

ThrusterCommand ThrusterSelection::select(const Vector3& torque_B_Nm) const {
    const Eigen::Vector4d forces_N = forces_by_torque_ * torque_B_Nm;
    const double full = std::max(forces_N.cwiseAbs().maxCoeff() / thruster_force_N, 1.0);
    ThrusterCommand command;
    for (std::size_t mount = 0; mount < mounts; ++mount) {
        const double force_N = forces_N[static_cast<Eigen::Index>(mount)] / full;
        const double on_s = std::abs(force_N) / thruster_force_N * seconds_per_tick;
        if (on_s < 0.5 * thruster_least_on_s) continue;
        command.on_s[2 * mount + (force_N > 0.0 ? 0 : 1)] = std::clamp(on_s, thruster_least_on_s, seconds_per_tick);
    }
    return command;
}

} // namespace aeolis::flight::gnc
