// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/reconstruction/error_filter.hpp"
#include "server/reconstruction/recorded_landing.hpp"

#include <optional>

namespace aeolis::reconstruction {

inline constexpr double path_step_s = 0.125;

/// A point of the path. Frame M; the standard deviations are of each axis.
struct PathPoint {
    Sclk at;
    flight::gnc::NavigatedState state;
    Vector3 sigma_p_m = Vector3::Zero(), sigma_v_mps = Vector3::Zero(), sigma_angle_rad = Vector3::Zero();
    double sigma_height_m = 0.0;
    Vector3 felt_M_mps2 = Vector3::Zero();                 ///< specific force, mean over the step that ends here
    std::optional<flight::gnc::NavigatedState> navigated;  ///< as flight recorded it within the 1/64 s before
};

struct Path {
    std::vector<PathPoint> points;  ///< one each path_step_s, from half a minute before entry to touchdown
    Vector3 accelerometer_bias_mps2 = Vector3::Zero();  ///< as felt in free fall before entry
    double target_radius_m = 0.0;
    Sclk entry;
    std::uint64_t readings = 0;         ///< of the IMU, between the first point and the last
    std::uint64_t readings_filled = 0;  ///< missing ones, replaced by the one before
    std::uint64_t breaks = 0;           ///< gaps too long for that: the path goes on from the navigated state
    std::uint64_t beams_taken = 0, beams_refused = 0;  ///< ranges and range rates
};

/// Where the rover stands, as orbiters' pictures show it the day after.
struct LandingSite {
    double latitude_deg = 0.0, longitude_deg = 0.0;  ///< areocentric, east
    double radius_m = 0.0;                           ///< of the ground
    double sigma_m = 10.0;                           ///< one standard deviation on each axis
};

/// Rebuilds the path of a landing from what it recorded: the IMU's readings from the navigated state before entry on,
/// corrected by the radar's, and by the place of the landing where that is known. R52
///
/// Fails when the recording holds no readings of the IMU, no navigated state near entry or no parameters; with a site,
/// when no touchdown was reported or the site is more than six standard deviations from where the path ends.
/// Rate     a second of processor time for a landing       Memory   50 MB
Result<Path> reconstruct(const RecordedLanding& recorded, const SensorErrors& errors = {},
                         const std::optional<LandingSite>& site = {});

}  // namespace aeolis::reconstruction
