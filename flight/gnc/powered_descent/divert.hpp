// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/quantities.hpp"
#include "flight/gnc/vector.hpp"
#include "generated/parameters.hpp"

#include <optional>

// The divert of the powered approach, away from the backshell: a sidestep that ends at rest.
//
//   s(t) = v0 t + c3 t³ + c4 t⁴ + c5 t⁵,  with s(T) = Δ, ṡ(T) = 0, s̈(0) = s̈(T) = 0
//   a_cmd = s̈ + k_v (ṡ − v) + k_p (s − x)
//
// Frame    the local horizontal plane at the start, as vectors in M        Units   m, s
// Source   [facts] Timeline: rest-to-rest quintic, 304 m, azimuth 112°; the term v0 t for a start that is not at rest,
//          and the gains, are our assumption
// Valid    T > 1 s; a rest-to-rest sidestep of 304 m in 18.6 s peaks at 1.875 Δ/T = 30.6 m/s
namespace aeolis::flight::gnc::powered_descent {

class Divert {
  public:
    /// Ends at rest at displacement_M + v0_M · duration_s / 2: the displacement counts from where the drift would end
    /// if it were nulled evenly, so that it costs the same with any drift.
    /// @param displacement_M  [m] horizontal
    /// @param v0_M            [m/s] horizontal velocity at the start
    void start(const Vector3& displacement_M, const Vector3& v0_M, double duration_s);

    Vector3 position_M(double t_s) const;  ///< from the start
    Vector3 velocity_M(double t_s) const;
    Vector3 acceleration_M(double t_s) const;  ///< zero after the end

    /// Horizontal acceleration to command at t; x and v are measured from the start.
    Vector3 command_M(const Parameters& parameters, double t_s, const Vector3& x_M, const Vector3& v_M) const;

    double duration_s() const { return duration_s_; }

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(v0_, c3_, c4_, c5_, duration_s_);
    }

  private:
    Vector3 v0_ = Vector3::Zero(), c3_ = Vector3::Zero(), c4_ = Vector3::Zero(), c5_ = Vector3::Zero();
    double duration_s_ = 1.0;
};

struct Sidestep {
    Vector3 displacement_M;
    Conditions conditions;  ///< by which the side was chosen. R38
};

/// The sidestep to fly: `divert_M`, or its opposite. Over the end of the sidestep the stage sinks until the rover stands.
/// The opposite is flown where the drifting backshell would come to within divert_clearance_min_m of that place, then or
/// in divert_clearance_for_s after it, and would stay farther from the opposite one.
/// @param v0_M    [m/s] horizontal velocity at the start
/// @param wind_M  [m/s] with which the backshell drifts; v0_M is taken for it where it is not known
Sidestep choose_sidestep(const Parameters& parameters, const Vector3& divert_M, const Vector3& v0_M,
                         const std::optional<Vector3>& wind_M, double duration_s);

/// Horizontal unit vector of an azimuth (from north to east) at p, in M.
Vector3 azimuth_direction(const Vector3& p_MoB_M, double azimuth_rad);

}  // namespace aeolis::flight::gnc::powered_descent
