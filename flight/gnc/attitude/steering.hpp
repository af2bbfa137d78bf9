// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/devices/device_messages.hpp"
#include "flight/gnc/attitude/attitude_control.hpp"
#include "flight/gnc/attitude/thruster_selection.hpp"
#include "flight/gnc/powered_descent/thrust_allocation.hpp"

namespace aeolis::flight::gnc {

/// Which effectors turn the vehicle: eight thrusters, or the engines by throttling apart from each other.
enum class Steers : std::uint8_t { thrusters, eight_engines, four_engines };

/// Attitude control down to its effectors: wanted attitude → torque → on-times of thrusters or throttles of engines.
///
/// In       what guidance wants, the navigated attitude, the inertia that is flown
/// Out      on-times; or throttles, changed about those that guidance asked for
/// Rate     64 Hz: each cycle, in order            Memory   what thrusters are owed
class Steering {
  public:
    explicit Steering(double engine_max_thrust_N) : engine_max_thrust_N_(engine_max_thrust_N) {}

    void cycle(const AttitudeCommand& wanted, const AttitudeState& state, const Inertia& inertia, Steers steers,
               ThrusterCommand& thrusters, EngineCommand& engines);

  private:
    double engine_max_thrust_N_;
    ThrusterSelection thruster_selection_;
    powered_descent::TorqueAllocation torque_allocation_;
};

}  // namespace aeolis::flight::gnc
