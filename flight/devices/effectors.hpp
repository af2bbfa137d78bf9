// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <numbers>

// Positions and directions of thrusters and descent engines, for flight software and simulation.
// Frame B, from the centre of mass [m]. Only the numbers of effectors and their forces are published; everything else
// is our assumption. [facts] Vehicle
namespace aeolis::flight {

struct Effector {
    std::array<double, 3> position_B_m{};
    std::array<double, 3> direction_B{};  ///< of the force on the vehicle, unit
};

inline constexpr std::size_t thruster_count = 8;
inline constexpr std::size_t engine_count = 8;
inline constexpr double thruster_force_N = 302.0;
inline constexpr double thruster_least_on_s = 0.004;  ///< shortest on-time of a valve; our assumption

namespace effector_detail {

/// Outward unit vector at a mount, by its azimuth about z.
struct Mount {
    double outward_x = 0.0, outward_y = 0.0;
};
constexpr Mount mount(std::size_t number) {
    constexpr double half = std::numbers::sqrt2 / 2.0;  // all mounts lie on diagonals
    constexpr Mount mounts[] = {{half, half}, {-half, half}, {-half, -half}, {half, -half}};
    return mounts[number];
}

}  // namespace effector_detail

/// Entry thrusters: two at each of four mounts on the backshell, pushing opposite ways along the rim.
/// Even: towards increasing azimuth (right-handed about z); odd: towards decreasing.
constexpr std::array<Effector, thruster_count> entry_thrusters() {
    constexpr double radius_m = 1.6, behind_m = 1.5;
    std::array<Effector, thruster_count> all{};
    for (std::size_t i = 0; i < thruster_count; ++i) {
        const auto at = effector_detail::mount(i / 2);
        const double sense = i % 2 == 0 ? 1.0 : -1.0;
        all[i] = {{radius_m * at.outward_x, radius_m * at.outward_y, -behind_m},
                  {-sense * at.outward_y, sense * at.outward_x, 0.0}};
    }
    return all;
}

/// Descent engines: two at each of four corners, canted along the rim to turn the vehicle about z too.
/// Numbered so that every other one is used in the sky crane: one in each corner, balanced about z.
constexpr std::array<Effector, engine_count> descent_engines() {
    constexpr double radius_m = 1.5, sine = 0.087, cosine = 0.9962082;  // 5°
    constexpr double senses[] = {1.0, -1.0, -1.0, 1.0, 1.0, -1.0, -1.0, 1.0};
    std::array<Effector, engine_count> all{};
    for (std::size_t i = 0; i < engine_count; ++i) {
        const auto at = effector_detail::mount(i / 2);
        all[i] = {{radius_m * at.outward_x, radius_m * at.outward_y, 0.0},
                  {-senses[i] * sine * at.outward_y, senses[i] * sine * at.outward_x, -cosine}};
    }
    return all;
}

/// Radii of gyration [m]: about z, and about any axis across it. Products of inertia are neglected.
struct Gyration {
    double along_z_m = 0.0, across_m = 0.0;
};
inline constexpr Gyration gyration_with_cruise_stage{1.35, 1.35};
inline constexpr Gyration gyration_of_entry_vehicle{1.26, 1.17};  // [facts] Vehicle: 4500 … 5500, 3800 … 4800 kg m²
inline constexpr Gyration gyration_without_heatshield{1.20, 1.15};
inline constexpr Gyration gyration_of_stage_with_rover{1.05, 1.00};
inline constexpr Gyration gyration_of_stage{0.95, 0.85};

}  // namespace aeolis::flight
