// SPDX-License-Identifier: Apache-2.0
#include "simulation/mars/wind.hpp"

#include <algorithm>
#include <iterator>

namespace aeolis::simulation {
namespace {

constexpr double waves_top_m = 5000.0;
constexpr double wave_east_length_m = 410.0;
constexpr double wave_north_length_m = 530.0;

WindRow row_at(std::span<const WindRow> rows, double altitude_m) {
    const auto above = std::ranges::lower_bound(rows, altitude_m, {}, &WindRow::altitude_m);
    if (above == rows.begin()) return rows.front();
    if (above == rows.end()) return rows.back();
    const WindRow& low = *std::prev(above);
    const double part = (altitude_m - low.altitude_m) / (above->altitude_m - low.altitude_m);
    return {altitude_m, low.east_mps + part * (above->east_mps - low.east_mps),
            low.north_mps + part * (above->north_mps - low.north_mps)};
}

}  // namespace

Wind::Wind(double steady_east_mps, double steady_north_mps, double deviation_mps, Random random, const Gusts& gusts,
           std::span<const WindRow> by_height)
    : east_mps_(steady_east_mps + deviation_mps * random.normal()),
      north_mps_(steady_north_mps + deviation_mps * random.normal()), wave_mps_(0.5 * deviation_mps),
      east_phase_rad_(2.0 * std::numbers::pi * random.uniform()),
      north_phase_rad_(2.0 * std::numbers::pi * random.uniform()), by_height_(by_height.begin(), by_height.end()),
      gusts_(gusts) {}

Vector3 Wind::at(const Vector3& p, double altitude_m) const {
    double east_mps = east_mps_ + shift_east_mps_;
    double north_mps = north_mps_ + shift_north_mps_;
    if (!by_height_.empty()) {
        const WindRow row = row_at(by_height_, altitude_m);
        east_mps += row.east_mps;
        north_mps += row.north_mps;
    }
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
