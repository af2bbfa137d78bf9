// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/attitude/attitude_command.hpp"
#include "flight/gnc/attitude/phase_plane.hpp"
#include "flight/gnc/vector.hpp"
#include "generated/parameters.hpp"

// Three-axis attitude control: from guidance's command to the torque required of thrusters or engines.
//
//   T = I · clamp((ω_wanted − ω) / τ) + ω × Iω,   zero while |ω_wanted − ω| is within its deadband
//
//   detumble     ω_wanted = 0, approached gently
//   entry_bank   in vacuum: the rotation to the trim attitude at the wanted bank, by the phase plane about its own
//                axis. In the air, which holds the vehicle at its own trim angle: the bank error about the velocity by
//                the phase plane, and damping of the rates across it
//   suspended    ω_wanted = 0 with a wide deadband: only swinging is damped
//   thrust       the shortest turn that puts −z of B along the wanted thrust, no roll
//
// Frame    B for rates and torque; M for positions, velocity and the thrust's direction
// Rate     64 Hz            Memory   none: each cycle is independent
// Source   [wie-1998]; bank limits [facts] Vehicle: 20°/s, 5°/s²; all other limits, gains and deadbands are our
//          assumption
namespace aeolis::flight::gnc {

struct AttitudeState {
    Vector3 p_MoB_M = Vector3::UnitX();
    Vector3 v_MB_M = Vector3::Zero();
    Quaternion q_MB = Quaternion::Identity();
    Vector3 rate_B_rps = Vector3::Zero();  ///< relative to inertial space
    bool in_air = false;                   ///< aerodynamic forces are felt: they hold the vehicle at trim
};

/// Moments of inertia about x (and y) and z of B. [kg m²]
struct Inertia {
    double across = 1.0, along_z = 1.0;
    Vector3 times(const Vector3& rate) const { return {across * rate.x(), across * rate.y(), along_z * rate.z()}; }
};

/// Torque for the next cycle. [N m] in B
Vector3 control_torque(const Parameters& parameters, const AttitudeCommand& command, const AttitudeState& state,
                       const Inertia& inertia);

/// Angle by which the vehicle must turn about its velocity to bring its lift to `bank_rad`; −π … π.
/// Measured from the x axis rather than from the tilt of z, so that it stays defined at zero angle of attack.
double bank_error(double bank_rad, const AttitudeState& state);

}  // namespace aeolis::flight::gnc
