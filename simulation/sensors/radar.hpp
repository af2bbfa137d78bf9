// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/devices/device_messages.hpp"
#include "simulation/draws.hpp"
#include "simulation/mars/point_mass.hpp"
#include "simulation/mars/terrain.hpp"
#include "simulation/random.hpp"
#include "simulation/scenario.hpp"

#include <array>
#include <cstdint>

namespace aeolis::simulation {

/// The landing radar: six beams in turn, each at 20 Hz.
///
/// Beam 0 along z of B, 1…3 at 20°, 4…5 at 50° from it. [facts]
/// Our assumptions: their azimuths (0°, 120°, 240°; 60°, 240°), ranges from 4 m to 12, 12 and 9 km (a flatter beam has
/// a weaker echo), at most 65° between beam and the ground's normal, and that a reading is as of its tick. A case has
/// one range scale error, and each beam its own velocity bias, with the scenario's deviations; noise on each reading
/// has half of that, and a fraction of the readings fails. The hung rover and the plume are not seen. Where the
/// scenario has moving sand, it spoils the velocity of one reading in twenty on the sky crane.
class Radar {
  public:
    /// `dropouts` draws the readings that fail, `sand` those that sand spoils.
    Radar(const Dispersions& dispersions, Random random, Random dropouts, Random sand);

    void add_draws(std::vector<Draw>& draws) const;

    static constexpr std::uint32_t beams = 6;
    static std::array<double, 3> direction_B(std::uint32_t beam);

    /// Whether the heatshield, `to_heatshield_M` away, blocks a beam.
    ///
    /// It does within 90 m, where it fills the beam's 3° [facts], in any part of the beam. Our assumption: beyond that
    /// the ground's echo is stronger.
    static bool hides(const Vector3& to_heatshield_M, const Vector3& direction_M);

    /// Measures with one beam now. `sand_moves`: engines blow at the ground from near.
    flight::RadarBeam measure(std::uint32_t beam, const PointMass& at, const Quaternion& q_MB, const Terrain& terrain,
                              bool sand_moves = false);

    /// Whether `beam` measures between two moments of the 1600 Hz grid (first excluded, last included).
    static bool due(std::uint32_t beam, std::int64_t after, std::int64_t until);

  private:
    double range_scale_, range_noise_fraction_, velocity_noise_mps_;
    std::array<double, beams> velocity_bias_mps_{};
    double dropout_fraction_, sand_mps_;
    Random noise_, dropouts_, sand_;
};

}  // namespace aeolis::simulation
