// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/attitude/attitude_control.hpp"
#include "flight/gnc/navigation/strapdown.hpp"
#include "flight/gnc/vector.hpp"
#include "generated/parameters.hpp"

#include <cstdint>

// Estimates specific force and rates while the IMU is silent, by extrapolating the last ones with a model of what
// carries the vehicle.
//
//   held by       force                                        turning
//   nothing       none                                         I ω̇ = T − ω × Iω
//   the air       f₀ (v/v₀)² exp((h₀−h)/H), fixed in B         with the velocity, and about it: ω̇ = (T/I)·v̂
//   a parachute   f₀ (v/v₀)² exp((h₀−h)/H), fixed in M         I ω̇ = T − ω × Iω + r × m f − c ω
//   engines       f₀ thrust/thrust₀, fixed in B                I ω̇ = T − ω × Iω
//
// T is the torque that attitude control commands. It continues to steer, by the attitude that the model gives.
//
// Frame    B for force, rates and torque         Rate     64 Hz, only while the IMU is silent
// Memory   what was felt when the silence began
// Valid    half a second at any time; two seconds where the rows above hold what turns the vehicle: not in reversals,
//          not while the parachute opens, not on engines (docs/faults.md)
// Source   our assumption; the parachute's row is the pendulum of the vehicle below the bridles' confluence
namespace aeolis::flight::gnc {

/// What carries the vehicle. `new_trim`: the air, while the ejected balance masses change the angle of attack.
enum class HeldBy : std::uint8_t { nothing, air, new_trim, parachute, engines };

/// Specific force and rate relative to inertial space, in B.
struct ForceAndRate {
    Vector3 force_B_mps2 = Vector3::Zero();
    Vector3 rate_B_rps = Vector3::Zero();
};

/// Quantities that are known without the IMU.
struct Surroundings {
    HeldBy held_by = HeldBy::nothing;
    Vector3 torque_B_Nm = Vector3::Zero();  ///< of thrusters or engines, as commanded
    Inertia inertia;
    double mass_kg = 1.0;
    double altitude_m = 0.0;
    double thrust_N = 0.0;
    Vector3 free_M_mps2 = Vector3::Zero();  ///< acceleration without any force
};

class DeadReckoning {
  public:
    /// Force and rates over the next `dt_s`. A silence's first call starts from `last`, the IMU's last measurement.
    ForceAndRate reckon(const Parameters& parameters, const Surroundings& now, const NavigatedState& state,
                        const ForceAndRate& last, double dt_s);
    /// Ends the silence.
    void end() { silent_s_ = 0.0; }

    double silent_s() const { return silent_s_; }

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(silent_s_, rate_B_rps_, force_B_mps2_, force_M_mps2_, speed_mps_, altitude_m_, thrust_N_);
    }

  private:
    Vector3 force_B(const Parameters& parameters, const Surroundings& now, const NavigatedState& state) const;
    Vector3 turn(const Parameters& parameters, const Surroundings& now, const NavigatedState& state,
                 const Vector3& force_B_mps2, double dt_s);

    double silent_s_ = 0.0;
    Vector3 rate_B_rps_ = Vector3::Zero();
    // As the silence began:
    Vector3 force_B_mps2_ = Vector3::Zero(), force_M_mps2_ = Vector3::Zero();
    double speed_mps_ = 0.0, altitude_m_ = 0.0, thrust_N_ = 0.0;
};

/// Navigation's error bound due to IMU silences; zero before the first. It widens while the IMU is silent, and
/// afterwards because the attitude is uncertain. The radar narrows it.
class Belief {
  public:
    /// Applies a measured or estimated `force_mps2` for `dt_s`.
    void pass(const Parameters& parameters, bool silent, HeldBy held_by, double force_mps2, double dt_s);
    /// Applies a radar correction, of which this fraction was accepted.
    void hear_radar(double gain);
    /// Applies an attitude correction from the radar.
    void narrow_attitude(const Parameters& parameters);

    double attitude_rad() const { return attitude_rad_; }
    double velocity_mps() const { return velocity_mps_; }
    double altitude_m() const { return altitude_m_; }

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(attitude_rad_, velocity_mps_, altitude_m_);
    }

  private:
    double attitude_rad_ = 0.0, velocity_mps_ = 0.0, altitude_m_ = 0.0;
};

}  // namespace aeolis::flight::gnc
