// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/devices/device_messages.hpp"
#include "flight/gnc/vector.hpp"

#include <Eigen/Core>

// Thruster on-times for a wanted torque.
//
//   The two thrusters of a mount push in exactly opposite directions: four signed forces a = J⁺ T, of least Σa². Each
//   is given by the thruster of its mount with that sign; on-time = |a| / F · cycle
//
// Frame    B          In   torque T [N m], mean over the cycle        Out   on-times [s] within one cycle of 1/64 s
// Limits   a torque beyond four full thrusters is scaled down, keeping its axis. An on-time too short for a valve is
//          owed to the mount and given once enough has accumulated: small torques become rare pulses
// Source   [wie-1998] (pseudo-inverse selection); the mounts are those of flight/devices/effectors.hpp
namespace aeolis::flight::gnc {

class ThrusterSelection {
  public:
    ThrusterSelection();

    /// Call in each cycle, in order.
    ThrusterCommand select(const Vector3& torque_B_Nm);

  private:
    Eigen::Matrix<double, 4, 3> forces_by_torque_;  ///< [1/m]
    Eigen::Vector4d owed_s_ = Eigen::Vector4d::Zero();
};

}  // namespace aeolis::flight::gnc
