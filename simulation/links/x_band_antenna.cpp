// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/x_band_antenna.hpp"

#include <algorithm>

namespace aeolis::simulation {
namespace {

constexpr double half_power_off_best_rad = 60.0 * degree_rad;  // our assumption
constexpr double least_gain = 0.01;                            // our assumption: leakage to the sides

double best_rad(XBandAntenna antenna) {
    return antenna == XBandAntenna::entry ? 0.0 : 70.0 * degree_rad;  // our assumption
}

}  // namespace

double x_band_gain(XBandAntenna antenna, const Vector3& earth_B) {
    const double from_axis_rad = std::acos(std::clamp(-earth_B.z(), -1.0, 1.0));
    const double off_best = (from_axis_rad - best_rad(antenna)) / half_power_off_best_rad;
    return std::max(least_gain, std::exp2(-off_best * off_best));
}

}  // namespace aeolis::simulation
