// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/powered_descent/vertical_profile.hpp"

#include "flight/gnc/mars.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::flight::gnc::powered_descent {

namespace {

double limited(const Parameters& parameters, double deceleration_mps2) {
    return std::clamp(deceleration_mps2, parameters.profile_deceleration_min_mps2,
                      parameters.profile_deceleration_max_mps2);
}

}  // namespace

double altitude_used_until_constant_velocity_m(const Parameters& parameters, double descent_rate_mps) {
    const double free_fall_s = parameters.powered_approach_delay_s;
    const double constant_velocity_mps = parameters.constant_velocity_mps;
    const double after_fall_mps = descent_rate_mps + mars_weight_mps2 * free_fall_s;
    const double fallen_m = 0.5 * (descent_rate_mps + after_fall_mps) * free_fall_s;
    const double approach_m = (after_fall_mps * after_fall_mps - constant_velocity_mps * constant_velocity_mps) /
                              (2.0 * parameters.approach_deceleration_mps2);
    return fallen_m + approach_m;
}

void ApproachProfile::start(const Parameters& parameters, double altitude_m, double descent_rate_mps) {
    const double constant_velocity_mps = parameters.constant_velocity_mps;
    const double room_m = std::max(altitude_m - approach_end_altitude_m(parameters), 1.0);
    deceleration_mps2_ =
        limited(parameters,
                (descent_rate_mps * descent_rate_mps - constant_velocity_mps * constant_velocity_mps) / (2.0 * room_m));
}

double ApproachProfile::descent_rate_mps(const Parameters& parameters, double altitude_m) const {
    const double constant_velocity_mps = parameters.constant_velocity_mps;
    const double above_m = std::max(altitude_m - approach_end_altitude_m(parameters), 0.0);
    return std::sqrt(constant_velocity_mps * constant_velocity_mps + 2.0 * deceleration_mps2_ * above_m);
}

double ApproachProfile::acceleration_mps2(const Parameters& parameters, double altitude_m,
                                          double descent_rate_mps) const {
    return deceleration_mps2_ +
           parameters.descent_rate_gain_per_s * (descent_rate_mps - this->descent_rate_mps(parameters, altitude_m));
}

double hold_rate_mps2(const Parameters& parameters, double descent_rate_mps, double wanted_mps) {
    return parameters.descent_rate_gain_per_s * (descent_rate_mps - wanted_mps);
}

double constant_deceleration_altitude_m(const Parameters& parameters, double descent_rate_mps) {
    const double sky_crane_mps = parameters.sky_crane_descent_rate_mps;
    return sky_crane_altitude_m(parameters) + (descent_rate_mps * descent_rate_mps - sky_crane_mps * sky_crane_mps) /
                                                  (2.0 * parameters.constant_deceleration_mps2);
}

void DecelerationProfile::start(const Parameters& parameters, double altitude_m, double descent_rate_mps) {
    rate_mps_ = descent_rate_mps;
    aim(parameters, altitude_m);
}

void DecelerationProfile::aim(const Parameters& parameters, double altitude_m) {
    const double sky_crane_mps = parameters.sky_crane_descent_rate_mps;
    const double room_m = std::max(altitude_m - sky_crane_altitude_m(parameters), 1.0);
    deceleration_mps2_ = limited(parameters, (rate_mps_ * rate_mps_ - sky_crane_mps * sky_crane_mps) / (2.0 * room_m));
}

void DecelerationProfile::advance(const Parameters& parameters, double altitude_m, double dt_s) {
    const double sky_crane_mps = parameters.sky_crane_descent_rate_mps;
    const double left_s = (rate_mps_ - sky_crane_mps) / deceleration_mps2_;
    if (left_s > parameters.deceleration_aim_last_s) aim(parameters, altitude_m);
    rate_mps_ = std::max(rate_mps_ - deceleration_mps2_ * dt_s, sky_crane_mps);
}

double DecelerationProfile::acceleration_mps2(const Parameters& parameters, double descent_rate_mps) const {
    const double planned_mps2 = rate_mps_ > parameters.sky_crane_descent_rate_mps ? deceleration_mps2_ : 0.0;
    return planned_mps2 + parameters.deceleration_rate_gain_per_s * (descent_rate_mps - rate_mps_);
}

}  // namespace aeolis::flight::gnc::powered_descent
