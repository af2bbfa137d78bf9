// SPDX-License-Identifier: Apache-2.0
#include "simulation/mars/terrain.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace aeolis::simulation {
namespace {

constexpr double slope_reach_m =
    30000.0;  // our assumption: level beyond, else a slope at the site would be a mountain at entry

/// A square of ground with heights drawn at its nodes, whose opposite edges are alike.
std::shared_ptr<const HeightGrid> rough_tile(double roughness_m, double length_m, Random& random) {
    constexpr std::size_t nodes = 64;  // chosen: by default it repeats after 3 km, more than the radar sees on engines
    std::vector<double> drawn(nodes * nodes);
    for (double& height_m : drawn) height_m = roughness_m * random.normal();
    std::vector<double> heights_m;
    heights_m.reserve((nodes + 1) * (nodes + 1));
    for (std::size_t row = 0; row <= nodes; ++row)
        for (std::size_t column = 0; column <= nodes; ++column)
            heights_m.push_back(drawn[row % nodes * nodes + column % nodes]);
    return std::make_shared<const HeightGrid>(HeightGrid::Shape{nodes + 1, nodes + 1, 0.0, 0.0, length_m},
                                              std::move(heights_m));
}

/// Where a place lies in the tile that is laid beside itself.
double in_tile_m(const HeightGrid& tile, double offset_m) {
    const double side_m = static_cast<double>(tile.shape().columns - 1) * tile.shape().cell_m;
    return offset_m - side_m * std::floor(offset_m / side_m);
}

}  // namespace

Terrain::Terrain(const Scenario& scenario, Random random)
    : landing_radius_m_(scenario.target.radius_m), grid_(scenario.ground.grid) {
    const Dispersions& errors = scenario.dispersions;
    height_m_ = scenario.ground.height_m + errors.terrain_height_m * random.normal();
    const double rise = std::tan(scenario.ground.slope_deg * degree_rad);
    const double azimuth_rad = scenario.ground.uphill_azimuth_deg * degree_rad;
    const double rise_error = std::tan(errors.terrain_slope_deg * degree_rad);
    const double east = rise * std::sin(azimuth_rad) + rise_error * random.normal();
    const double north = rise * std::cos(azimuth_rad) + rise_error * random.normal();
    const Horizon target =
        horizon(place(scenario.target.latitude_deg * degree_rad, scenario.target.longitude_deg * degree_rad, 1.0));
    rise_M_ = east * target.east + north * target.north;
    east_M_ = target.east;
    north_M_ = target.north;
    if (errors.terrain_roughness_m > 0.0)
        tile_ = rough_tile(errors.terrain_roughness_m, scenario.ground.roughness_length_m, random);
}

double Terrain::uneven_m(double east_m, double north_m) const {
    return (grid_ ? grid_->height_m(east_m, north_m) : 0.0) +
           (tile_ ? tile_->height_m(in_tile_m(*tile_, east_m), in_tile_m(*tile_, north_m)) : 0.0);
}

HeightGrid::Rise Terrain::uneven_rise(double east_m, double north_m) const {
    HeightGrid::Rise rise;
    if (grid_) rise = grid_->rise(east_m, north_m);
    if (tile_) {
        const auto rough = tile_->rise(in_tile_m(*tile_, east_m), in_tile_m(*tile_, north_m));
        rise.east += rough.east;
        rise.north += rough.north;
    }
    return rise;
}

double Terrain::radius_m(const Vector3& p) const {
    const double level_beyond_m = slope_reach_m * rise_M_.norm();
    const double plane_m = landing_radius_m_ + height_m_ +
                           std::clamp(landing_radius_m_ * p.dot(rise_M_) / p.norm(), -level_beyond_m, level_beyond_m);
    return is_uneven() ? plane_m + uneven_m(from_target_m(p, east_M_), from_target_m(p, north_M_)) : plane_m;
}

Vector3 Terrain::normal(const Vector3& p) const {
    const Vector3 up = p.normalized();
    if (!is_uneven()) return (up - (rise_M_ - rise_M_.dot(up) * up)).normalized();
    const auto uneven = uneven_rise(from_target_m(p, east_M_), from_target_m(p, north_M_));
    const Vector3 rise_M = rise_M_ + uneven.east * east_M_ + uneven.north * north_M_;
    return (up - (rise_M - rise_M.dot(up) * up)).normalized();
}

Terrain::Meeting Terrain::meet_uneven(const Vector3& p, const Vector3& direction_M) const {
    constexpr double near_m = 0.01, near_fraction = 1.0e-5;  // chosen: below any noise of a radar
    constexpr double reach_m = 50000.0;                      // chosen: above its range
    constexpr int steps_max = 1000;  // chosen: at 65° over a grid with a slope of 7 a beam takes some 200
    const double steepest = (grid_ ? grid_->steepest() : 0.0) + (tile_ ? tile_->steepest() : 0.0) + rise_M_.norm();
    double range_m = 0.0;
    for (int step = 0; step < steps_max && range_m < reach_m; ++step) {
        const Vector3 at = p + range_m * direction_M;
        const double over_m = height_m(at);
        if (over_m < near_m + near_fraction * range_m) return {true, range_m, -direction_M.dot(normal(at))};
        // The ray comes no faster towards the ground than it falls, and than the ground rises below it.
        const double falls = -direction_M.dot(at) / at.norm();
        const double nears = falls + steepest * std::sqrt(std::max(0.0, 1.0 - falls * falls));
        if (nears <= 0.0) return {};
        range_m += over_m / nears;
    }
    return {};
}

Terrain::Meeting Terrain::meet(const Vector3& p, const Vector3& direction_M) const {
    if (is_uneven()) return meet_uneven(p, direction_M);
    const double ground_m = radius_m(p);
    const Vector3 up = p.normalized();
    const Vector3 upright = normal(p);
    // |q + s d| = ground radius, the nearer root; q from the centre of the sphere that touches the ground below.
    const Vector3 q = p + ground_m * (upright - up);
    const double half_b = q.dot(direction_M);
    const double distance_m = q.norm();
    const double c = (distance_m - ground_m) * (distance_m + ground_m);
    const double discriminant = half_b * half_b - c;
    if (half_b >= 0.0 || discriminant < 0.0 || c < 0.0) return {};
    return {true, c / (-half_b + std::sqrt(discriminant)), -direction_M.dot(upright)};
}

}  // namespace aeolis::simulation
