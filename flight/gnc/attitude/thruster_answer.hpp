// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/devices/device_messages.hpp"
#include "flight/gnc/attitude/attitude_control.hpp"
#include "flight/gnc/vector.hpp"
#include "generated/parameters.hpp"

#include <array>
#include <optional>

// The part of the commanded thruster pulses that the IMU feels: 1 of thrusters that obey, 0 of those that do not.
//
//   felt part = Σ x·y / Σ x·x
//   about z        x: the change of the rate that pulses should have made in a cycle; y: the measured one. Neither
//                  air nor parachute pushes about the axis of symmetry
//   about x and y  the changes of both from one cycle to the next, because air and parachute swing the vehicle, but
//                  slowly: a pulse begins and ends within a cycle or two
//
// Nothing is said until Σ x·x is large enough to stand out of the gyros' noise.
//
// Frame    B          Units   rad/s          Rate   64 Hz: each cycle, in order
// Delay    A pulse commanded in cycle n acts from tick n + 1 and the valve's delay on, and is in the rates of ticks
//          n + 2 and n + 3: half in each, on average
// Source   ours: the least-squares slope of y over x
namespace aeolis::flight::gnc {

class ThrusterAnswer {
  public:
    /// Judges the rate at this tick; none: the IMU measured none. Returns the felt part once enough was commanded, and
    /// begins anew.
    std::optional<double> feel(const Parameters& parameters, const std::optional<Vector3>& rate_B_rps);
    /// Takes the pulses that are commanded in this cycle, after feel().
    void command(const ThrusterCommand& pulses, const Inertia& inertia);
    /// Begins anew: what was commanded so far need not be obeyed.
    void forget() { *this = {}; }

  private:
    std::array<Vector3, 4> turns_{Vector3::Zero(), Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};  // newest first
    std::array<std::optional<Vector3>, 2> rates_B_rps_;  // of the last ticks, newest first
    double commanded_ = 0.0, felt_ = 0.0;                // Σ x·x, Σ x·y
};

}  // namespace aeolis::flight::gnc
