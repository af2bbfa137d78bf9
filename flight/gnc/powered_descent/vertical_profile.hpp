// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "generated/parameters.hpp"

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

/// Height of the stage when touchdown is declared, from which the published heights count: the bridle, and the stage
/// above it, less what it sinks while thrust settles after the wheels' first contact.
constexpr double stage_height_at_touchdown_m(const Parameters& parameters) {
    return parameters.bridle_length_m + parameters.stage_above_bridle_m -
           parameters.sky_crane_descent_rate_mps * parameters.touchdown_settle_s;
}
/// Altitude at which the powered approach ends.
constexpr double approach_end_altitude_m(const Parameters& parameters) {
    return parameters.powered_approach_end_altitude_m + stage_height_at_touchdown_m(parameters);
}
/// Altitude of throttle-down.
constexpr double sky_crane_altitude_m(const Parameters& parameters) {
    return parameters.sky_crane_altitude_m + stage_height_at_touchdown_m(parameters);
}

/// Altitude used by design in free fall and approach, for a descent rate at backshell separation.
double altitude_used_until_constant_velocity_m(const Parameters& parameters, double descent_rate_mps);

class ApproachProfile {
  public:
    void start(const Parameters& parameters, double altitude_m, double descent_rate_mps);
    double descent_rate_mps(const Parameters& parameters, double altitude_m) const;
    /// The acceleration to command, positive up.
    double acceleration_mps2(const Parameters& parameters, double altitude_m, double descent_rate_mps) const;
    double deceleration_mps2() const { return deceleration_mps2_; }

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(deceleration_mps2_);
    }

  private:
    double deceleration_mps2_ = Parameters{}.approach_deceleration_mps2;  ///< until it starts
};

/// Upward acceleration that holds a descent rate.
double hold_rate_mps2(const Parameters& parameters, double descent_rate_mps, double wanted_mps);

/// Altitude at which constant deceleration must begin at a descent rate.
double constant_deceleration_altitude_m(const Parameters& parameters, double descent_rate_mps);

class DecelerationProfile {
  public:
    void start(const Parameters& parameters, double altitude_m, double descent_rate_mps);
    void advance(const Parameters& parameters, double altitude_m, double dt_s);
    double descent_rate_mps() const { return rate_mps_; }
    double acceleration_mps2(const Parameters& parameters, double descent_rate_mps) const;  ///< up, to command
    double deceleration_mps2() const { return deceleration_mps2_; }

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(rate_mps_, deceleration_mps2_);
    }

  private:
    void aim(const Parameters& parameters, double altitude_m);

    double rate_mps_ = Parameters{}.constant_velocity_mps;  ///< until it starts; so is the next
    double deceleration_mps2_ = Parameters{}.constant_deceleration_mps2;
};

}  // namespace aeolis::flight::gnc::powered_descent
