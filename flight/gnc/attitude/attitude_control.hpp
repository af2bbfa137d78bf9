// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/attitude/attitude_command.hpp"
#include "flight/gnc/attitude/phase_plane.hpp"
#include "flight/gnc/vector.hpp"

// Three-axis attitude control: from what guidance wants to the torque that thrusters or engines must give.
//
//   T = I · clamp((ω_wanted − ω) / τ) + ω × Iω,   nothing while |ω_wanted − ω| is within its deadband
//
//   detumble     ω_wanted = 0, brought down gently entry_bank   in vacuum: the rotation to the trim attitude at the
//   wanted bank, about its own axis, by the phase plane; in the air, which holds the vehicle at its own trim angle: the
//   bank error about the velocity by the phase plane, and the damping of what turns it across suspended    ω_wanted = 0
//   beyond a wide deadband: only what swings is damped thrust       the shortest turn that lays −z of B along the
//   wanted thrust, no roll
//
// Frame    B for rates and torque; M for positions, velocity and the thrust's direction
// Rate     64 Hz            Memory   none: every cycle by itself
// Source   [wie-1998]; bank limits [facts] Vehicle: 20°/s, 5°/s²; all other limits, gains and deadbands ours
namespace aeolis::flight::gnc {

struct AttitudeState {
    Vector3 p_MoB_M = Vector3::UnitX();
    Vector3 v_MB_M = Vector3::Zero();
    Quaternion q_MB = Quaternion::Identity();
    Vector3 rate_B_rps = Vector3::Zero();  ///< relative to inertial space
    bool in_air = false;                   ///< the air is felt: it holds the vehicle at trim
};

/// Moments of inertia about x (and y) and z of B. [kg m²]
struct Inertia {
    double across = 1.0, along_z = 1.0;
    Vector3 times(const Vector3& rate) const { return {across * rate.x(), across * rate.y(), along_z * rate.z()}; }
};

/// The torque for the next cycle. [N m] in B
Vector3 control_torque(const AttitudeCommand& command, const AttitudeState& state, const Inertia& inertia);

/// How far the vehicle, by its x axis, has to be turned about its velocity to have its lift at `bank_rad`; −π … π.
/// By x rather than by the lean of z: it holds when the vehicle flies straight.
double bank_error(double bank_rad, const AttitudeState& state);

}  // namespace aeolis::flight::gnc
