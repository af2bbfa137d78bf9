// SPDX-License-Identifier: Apache-2.0
#include "simulation/mars/wind.hpp"

namespace aeolis::simulation {
namespace {

constexpr double waves_top_m = 5000.0;
constexpr double wave_east_length_m = 410.0;
constexpr double wave_north_length_m = 530.0;

}  // namespace

Wind::Wind(double steady_east_mps, double steady_north_mps, double deviation_mps, Random random, const Gusts& gusts)
    : east_mps_(steady_east_mps + deviation_mps * random.normal()),
      north_mps_(steady_north_mps + deviation_mps * random.normal()), wave_mps_(0.5 * deviation_mps),
      east_phase_rad_(2.0 * std::numbers::pi * random.uniform()),
      north_phase_rad_(2.0 * std::numbers::pi * random.uniform()), gusts_(gusts) {}

Vector3 Wind::at(const Vector3& p, double altitude_m) const {
    double east_mps = east_mps_;
    double north_mps = north_mps_;
    if (altitude_m < waves_top_m && wave_mps_ != 0.0) {
        const double fade = wave_mps_ * (1.0 - altitude_m / waves_top_m);
        east_mps += fade * std::sin(2.0 * std::numbers::pi * altitude_m / wave_east_length_m + east_phase_rad_);
        north_mps += fade * std::sin(2.0 * std::numbers::pi * altitude_m / wave_north_length_m + north_phase_rad_);
    }
    const bool gusty = gusts_.blow_at(altitude_m);
    if (east_mps == 0.0 && north_mps == 0.0 && !gusty) return Vector3::Zero();
    const Horizon local = horizon(p);
    const Vector3 steady = east_mps * local.east + north_mps * local.north;
    return gusty ? Vector3{steady + gusts_.at(altitude_m, local)} : steady;
}

}  // namespace aeolis::simulation
