// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/devices/device_messages.hpp"
#include "simulation/vectors.hpp"

#include <array>

namespace aeolis::simulation {

/// Eight entry thrusters of 302 N, specific impulse 220 s [facts], mounted as in flight/devices/effectors.hpp.
///
/// Pulses are rectangular. Our assumption: a valve opens and closes 4 ms after its command, and stays open for at least
/// 4 ms.
class Thrusters {
  public:
    /// Sets the pulses of the cycle that begins now.
    void command(const flight::ThrusterCommand& command, bool enabled, double now_s);

    /// Mean force and torque over a step, in B, and the propellant burnt. The torque is about the origin of
    /// effectors.hpp.
    struct Push {
        Vector3 force_B = Vector3::Zero();
        Vector3 torque_B = Vector3::Zero();
        double propellant_kg = 0.0;
    };
    Push mean(double now_s, double step_s) const;

  private:
    struct Pulse {
        double from_s = 0.0, until_s = 0.0;
    };
    /// Two pulses a thruster: the last may still burn when the next is commanded.
    std::array<std::array<Pulse, 2>, 8> pulses_{};
    double last_until_s_ = 0.0;
};

}  // namespace aeolis::simulation
