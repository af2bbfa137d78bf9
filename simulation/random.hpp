// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace aeolis::simulation {

/// The purpose of a draw. Each error source has its own stream, so that switching one off does not change the others.
enum class Stream : std::uint64_t {
    delivery = 1,
    knowledge,
    density,
    drag,
    parachute,
    wind,
    imu,
    star_scanner,
    radar,
    devices,
    uhf,
    x_band,
    swing,
    imu_b,
    radar_b,
    bus_64_hz,
    bus_8_hz,
    imu_link,
    imu_mounting,
    imu_b_mounting,
    radar_dropout,
    radar_b_dropout,
    gust,
    terrain,
    x_band_noise,
    mass,
    slow_drag,
    uplink,
    relay,
    carrier,
    rover_imu,
    placing,
    parachute_oscillation,
    radar_sand,
    radar_b_sand,
};

/// Random numbers of one stream of one case of one seed: SplitMix64, and Box–Muller for the normal distribution.
///
/// The standard library's distributions differ between implementations. A value: copies continue alike. Source:
/// [steele-2014], [box-muller-1958].
class Random {
  public:
    Random(std::uint64_t seed, std::uint64_t case_number, Stream stream);

    std::uint64_t bits();
    double uniform();  ///< in [0, 1)
    double normal();   ///< mean 0, standard deviation 1
    std::array<double, 3> normal3();

  private:
    std::uint64_t state_;
};

}  // namespace aeolis::simulation
