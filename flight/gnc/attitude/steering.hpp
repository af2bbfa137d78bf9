// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/devices/device_messages.hpp"
#include "flight/gnc/attitude/attitude_control.hpp"
#include "flight/gnc/attitude/thruster_selection.hpp"
#include "flight/gnc/powered_descent/thrust_allocation.hpp"

namespace aeolis::flight::gnc {

/// Effectors that turn the vehicle: the eight thrusters, or the engines by differential throttling.
enum class Steers : std::uint8_t { thrusters, eight_engines, four_engines };

/// Attitude control down to its effectors: wanted attitude → torque → thruster on-times or throttles.
///
/// In       guidance's command, the navigated attitude, the inertia of the present configuration
/// Out      on-times; or throttles, varied about those that guidance commanded
/// Rate     64 Hz: each cycle, in order            Memory   on-time still owed by the thrusters
class Steering {
  public:
    explicit Steering(double engine_max_thrust_N) : engine_max_thrust_N_(engine_max_thrust_N) {}

    void cycle(const Parameters& parameters, const AttitudeCommand& wanted, const AttitudeState& state,
               const Inertia& inertia, Steers steers, ThrusterCommand& thrusters, EngineCommand& engines);

    /// The torque wanted in the last cycle. [N m] in B
    const Vector3& torque_B_Nm() const { return torque_B_Nm_; }

  private:
    double engine_max_thrust_N_;
    ThrusterSelection thruster_selection_;
    powered_descent::TorqueAllocation torque_allocation_;
    Vector3 torque_B_Nm_ = Vector3::Zero();
};

}  // namespace aeolis::flight::gnc
