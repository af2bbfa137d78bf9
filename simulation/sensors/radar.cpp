// SPDX-License-Identifier: Apache-2.0
#include "simulation/sensors/radar.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::simulation {
namespace {

constexpr double least_range_m = 4.0;                                                          // our assumption
constexpr std::array<double, Radar::beams> largest_range_m{12e3, 12e3, 12e3, 12e3, 9e3, 9e3};  // our assumption
constexpr double largest_incidence_rad = 65.0 * degree_rad;                                    // our assumption
constexpr std::array<double, Radar::beams> off_axis_deg{0.0, 20.0, 20.0, 20.0, 50.0, 50.0};    // [facts]
constexpr std::array<double, Radar::beams> azimuth_deg{0.0, 0.0, 120.0, 240.0, 60.0, 240.0};   // our assumption
constexpr double heatshield_radius_m = 2.25;                                                   // [facts]
constexpr double half_beam_rad = 1.5 * degree_rad;                                             // [facts]
constexpr double spoilt_by_sand = 0.05;   // our assumption: sporadic, as was told of the flown landing
constexpr double hides_within_m = 90.0;   // our assumption: see the header
constexpr std::int64_t period_grid = 80;  // of 1/1600 s: 20 Hz
constexpr std::array<std::int64_t, Radar::beams> phase_grid{0, 13, 27, 40, 53, 67};

}  // namespace

Radar::Radar(const Dispersions& dispersions, Random random, Random dropouts, Random sand)
    : range_scale_(1.0 + dispersions.radar_range_fraction * random.normal()),
      range_noise_fraction_(0.5 * dispersions.radar_range_fraction),
      velocity_noise_mps_(0.5 * dispersions.radar_velocity_mps), dropout_fraction_(dispersions.radar_dropout_fraction),
      sand_mps_(dispersions.radar_sand_mps), noise_(random), dropouts_(dropouts), sand_(sand) {
    for (double& bias_mps : velocity_bias_mps_) bias_mps = dispersions.radar_velocity_mps * noise_.normal();
}

std::array<double, 3> Radar::direction_B(std::uint32_t beam) {
    const double off_rad = off_axis_deg[beam] * degree_rad;
    const double azimuth_rad = azimuth_deg[beam] * degree_rad;
    return {std::sin(off_rad) * std::cos(azimuth_rad), std::sin(off_rad) * std::sin(azimuth_rad), std::cos(off_rad)};
}

bool Radar::hides(const Vector3& to_heatshield_M, const Vector3& direction_M) {
    const double distance_m = to_heatshield_M.norm();
    if (distance_m <= heatshield_radius_m) return true;
    if (distance_m > hides_within_m) return false;
    const double off_rad = std::acos(std::clamp(to_heatshield_M.dot(direction_M) / distance_m, -1.0, 1.0));
    return off_rad <= std::asin(heatshield_radius_m / distance_m) + half_beam_rad;
}

void Radar::add_draws(std::vector<Draw>& draws) const {
    draws.push_back({"radar_range_fraction", range_scale_ - 1.0});
    for (std::size_t beam = 0; beam < beams; ++beam)
        draws.push_back({"radar_velocity_" + std::to_string(beam) + "_mps", velocity_bias_mps_.at(beam)});
}

flight::RadarBeam Radar::measure(std::uint32_t beam, const PointMass& at, const Quaternion& q_MB,
                                 const Terrain& terrain, bool sand_moves) {
    flight::RadarBeam reading;
    reading.beam = static_cast<std::uint8_t>(beam);
    reading.direction_B = direction_B(beam);
    const Vector3 direction_M = q_MB * vector3(reading.direction_B);
    const Terrain::Meeting truth = terrain.meet(at.p_MoB_M, direction_M);
    // Drawn even for an invalid reading, so that the stream stays in step.
    const double range_noise = noise_.normal();
    const double velocity_noise = noise_.normal();
    const bool fails = dropouts_.uniform() < dropout_fraction_;
    double sand_mps = 0.0;
    if (sand_mps_ > 0.0 && sand_moves && sand_.uniform() < spoilt_by_sand) sand_mps = sand_mps_ * sand_.normal();
    reading.valid = !fails && truth.meets && truth.range_m >= least_range_m && truth.range_m <= largest_range_m[beam] &&
                    truth.incidence_cosine >= std::cos(largest_incidence_rad);
    if (!reading.valid) return reading;
    reading.range_m = truth.range_m * (range_scale_ + range_noise_fraction_ * range_noise);
    reading.range_rate_mps =
        -at.v_MB_M.dot(direction_M) + velocity_bias_mps_[beam] + velocity_noise_mps_ * velocity_noise + sand_mps;
    return reading;
}

bool Radar::due(std::uint32_t beam, std::int64_t after, std::int64_t until) {
    const auto turns = [&](std::int64_t grid) { return (grid - phase_grid[beam] + period_grid) / period_grid; };
    return turns(until) > turns(after);
}

}  // namespace aeolis::simulation
