// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/vectors.hpp"

#include <cstdint>

namespace aeolis::simulation {

/// The low-gain X-band antennas on the backshell. One is in use: the timeline switches to the parachute's while the
/// vehicle straightens up.
///
/// Our assumption, because the mission's patterns are not published here: both are symmetric about z of B, so rolling
/// changes nothing; 3 dB below their best at 60° to either side of it, and nowhere below −20 dB.
///
///   entry      best away from the heatshield (−z of B), where Earth is from cruise until the parachute opens
///   parachute  best at 70° from there: under the parachute −z points up and Earth stands at the horizon
enum class XBandAntenna : std::uint8_t { entry, parachute };

/// Power towards Earth relative to the antenna's best direction, as a ratio, 0.01 … 1. `earth_B`: unit vector, in B.
double x_band_gain(XBandAntenna antenna, const Vector3& earth_B);

}  // namespace aeolis::simulation
