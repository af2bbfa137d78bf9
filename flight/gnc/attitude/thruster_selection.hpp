// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/devices/device_messages.hpp"
#include "flight/gnc/vector.hpp"

#include <Eigen/Core>

// Which thrusters burn how long for a wanted torque.
//
//   The two thrusters of a mount push exactly against each other: four signed forces a = J⁺ T, of least Σa², each given
//   by the one thruster of its mount that has its sign; on-time = |a| / F · cycle
//
// Frame    B          In   torque T [N m], mean over the cycle        Out   on-times [s] within one cycle of 1/64 s
// Limits   what four full thrusters cannot give is cut in proportion, so that the axis stays. What is too short for a
//          valve is owed to the mount and given once there is enough: small torques become rare pulses
// Source   [wie-1998] (pseudo-inverse selection); the mounts are flight/devices/effectors.hpp's
namespace aeolis::flight::gnc {

class ThrusterSelection {
  public:
    ThrusterSelection();

    /// For each cycle, in order.
    ThrusterCommand select(const Vector3& torque_B_Nm);

  private:
    Eigen::Matrix<double, 4, 3> forces_by_torque_;  ///< [1/m]
    Eigen::Vector4d owed_s_ = Eigen::Vector4d::Zero();
};

}  // namespace aeolis::flight::gnc
