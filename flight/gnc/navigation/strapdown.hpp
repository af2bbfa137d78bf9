// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/devices/device_messages.hpp"
#include "flight/gnc/vector.hpp"
#include "flight/load.hpp"
#include "generated/parameters.hpp"

#include <cstdint>

// Strapdown inertial navigation: integrates the IMU's increments to attitude, velocity and position.
//
//   R_MB ← Exp(−ω Δt) · R_MB · Exp(Δθ)
//   v    ← v + R_MB½ · Δv + (g(p) − 2 ω×v − ω×(ω×p)) Δt
//   p    ← p + (v before + v after)/2 · Δt
//
// Frame    M (rotating Mars) for p and v; q_MB transforms components in B into M
// In       IMU increments, 200 Hz        Out   the navigated state at the time of the last increment, or reckoned
// Faults   lost increments are replaced by the last one received, up to `gap_max`; while none arrives, dead
//          reckoning supplies force and rates, and the count of the next increment tells what is still missing
// Source   [savage-1998] (attitude, then velocity with half of the rotation); [titterton-2004] for M's rates
// Valid    rates below 1 rad/s (Δθ below 5e-3 rad a step: error of the step below 1e-8 rad)
namespace aeolis::flight::gnc {

inline constexpr double imu_period_s = 1.0 / 200.0;  ///< [facts] Vehicle
inline constexpr std::uint32_t gap_max = static_cast<std::uint32_t>(build_parameters.imu_gap_max);

struct NavigatedState {
    Vector3 p_MoB_M = Vector3::Zero();  ///< [m]
    Vector3 v_MB_M = Vector3::Zero();   ///< [m/s] relative to rotating Mars
    Quaternion q_MB = Quaternion::Identity();
};

class Strapdown {
  public:
    /// `gravity_fraction`: by which gravity is taken for stronger near the ground, see local_gravity.
    explicit Strapdown(double gravity_fraction) : gravity_fraction_(gravity_fraction) {}
    Strapdown() = default;

    void start(const NavigatedState& state) { state_ = state; }
    void set_attitude(const Quaternion& q_MB) { state_.q_MB = q_MB; }
    void correct(const Vector3& dp_M, const Vector3& dv_M) {
        state_.p_MoB_M += dp_M;
        state_.v_MB_M += dv_M;
    }
    void shift(const NavigationShift& by);

    /// Integrates one increment.
    /// With `force_felt` false the specific force is taken as zero, and the bias is learnt from the measurement: in
    /// vacuum the accelerometers measure only their bias.
    void on(const Parameters& parameters, const ImuSample& sample, bool force_felt);

    /// Advances by `dt_s`, about a tick, with force and rates that the IMU did not measure.
    void reckon(const Vector3& force_B_mps2, const Vector3& rate_B_rps, double dt_s);

    /// Advances by any `dt_s` without the IMU: no force, and the last rate of rotation.
    void coast(double dt_s);

    /// Corrects attitude by a small angle about an axis in M. The velocity, which the radar measures in B, turns with
    /// it.
    void turn(const Vector3& angle_M_rad);

    const NavigatedState& state() const { return state_; }
    const Vector3& specific_force_B_mps2() const { return specific_force_B_mps2_; }  ///< of the last increment
    const Vector3& rate_B_rps() const { return rate_B_rps_; }                        ///< relative to inertial space
    const Vector3& bias_B_mps2() const { return bias_B_mps2_; }
    std::uint32_t filled() const { return filled_; }

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(state_.p_MoB_M, state_.v_MB_M, state_.q_MB, specific_force_B_mps2_, rate_B_rps_, bias_B_mps2_,
                 bias_samples_, last_count_, filled_, reckoned_s_, counting_);
    }

  private:
    void step(const Vector3& delta_angle_B, const Vector3& delta_v_B, double dt_s);
    void fill(std::uint32_t missing);

    double gravity_fraction_ = 0.0;
    NavigatedState state_;
    Vector3 specific_force_B_mps2_ = Vector3::Zero();
    Vector3 rate_B_rps_ = Vector3::Zero();
    Vector3 bias_B_mps2_ = Vector3::Zero();
    std::uint32_t bias_samples_ = 0;
    std::uint32_t last_count_ = 0;
    std::uint32_t filled_ = 0;
    double reckoned_s_ = 0.0;  ///< since the last increment
    bool counting_ = false;
};

/// `state` after `seconds` (may be negative) under gravity alone; its attitude stays inertially fixed.
/// Runge–Kutta 4 at steps of at most 1 s. Error below 1 m over two hours outside the atmosphere.
NavigatedState propagate(const NavigatedState& state, double seconds);

}  // namespace aeolis::flight::gnc
