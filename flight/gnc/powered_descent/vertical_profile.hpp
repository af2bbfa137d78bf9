// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "generated/dictionary_flight.hpp"

// Vertical profile of powered descent: descent rate at each altitude, and acceleration to keep it.
//
//   approach         v_ref(h)² = 32² + 2 a (h − h_end), a fixed at the start by the altitude left
//   constant rate    32 m/s until h = h_sky_crane + (32² − 0.75²) / (2 · 4.26): absorbs the radar's altitude error
//   constant decel.  v_ref(t) = v_start − ∫ a, down to 0.75 m/s. a is chosen to end at h_sky_crane from the present
//                    altitude: constant except for the radar's corrections
//   command          a_up = a_ref + k (v − v_ref), with 2 k in constant deceleration
//
// Frame    h [m] of the descent stage above ground, v [m/s] and a [m/s²]: v positive down, a positive up
// Source   [facts] Timeline (32 and 0.75 m/s; net 3.19 and 4.26 m/s²; heights); gain k is our assumption
// Valid    90 … 0.75 m/s; net decelerations are limited to 1 … 6 m/s², which the thrust of [facts] Vehicle allows
namespace aeolis::flight::gnc::powered_descent {

/// Height of the stage when the wheels touch the ground: the bridle, and the stage above the bridle.
inline constexpr double stage_height_at_touchdown_m = parameters.bridle_length_m + parameters.stage_above_bridle_m;
inline constexpr double constant_velocity_mps = parameters.constant_velocity_mps;
inline constexpr double sky_crane_mps = parameters.sky_crane_descent_rate_mps;
inline constexpr double approach_end_altitude_m =
    parameters.powered_approach_end_altitude_m + stage_height_at_touchdown_m;
inline constexpr double sky_crane_altitude_m = parameters.sky_crane_altitude_m + stage_height_at_touchdown_m;
inline constexpr double approach_deceleration_mps2 = parameters.approach_deceleration_mps2;
inline constexpr double constant_deceleration_mps2 = parameters.constant_deceleration_mps2;
/// Time from backshell separation to powered approach.
inline constexpr double free_fall_s = parameters.powered_approach_delay_s;
inline constexpr double rate_gain_per_s = parameters.descent_rate_gain_per_s;

/// Altitude used by design in free fall and approach, for a descent rate at backshell separation.
double altitude_used_until_constant_velocity_m(double descent_rate_mps);

class ApproachProfile {
  public:
    void start(double altitude_m, double descent_rate_mps);
    double descent_rate_mps(double altitude_m) const;
    double acceleration_mps2(double altitude_m, double descent_rate_mps) const;  ///< up, to command
    double deceleration_mps2() const { return deceleration_mps2_; }

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(deceleration_mps2_);
    }

  private:
    double deceleration_mps2_ = approach_deceleration_mps2;
};

/// Upward acceleration that holds a descent rate.
double hold_rate_mps2(double descent_rate_mps, double wanted_mps);

/// Altitude at which constant deceleration must begin at a descent rate.
double constant_deceleration_altitude_m(double descent_rate_mps);

class DecelerationProfile {
  public:
    void start(double altitude_m, double descent_rate_mps);
    void advance(double altitude_m, double dt_s);
    double descent_rate_mps() const { return rate_mps_; }
    double acceleration_mps2(double descent_rate_mps) const;  ///< up, to command
    double deceleration_mps2() const { return deceleration_mps2_; }

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(rate_mps_, deceleration_mps2_);
    }

  private:
    void aim(double altitude_m);

    double rate_mps_ = constant_velocity_mps;
    double deceleration_mps2_ = constant_deceleration_mps2;
};

}  // namespace aeolis::flight::gnc::powered_descent
