// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/prediction.pb.h"
#include "aeolis/v1/touchdown.pb.h"
#include "server/archive/reader.hpp"
#include "telemetry/touchdown.hpp"

#include <array>
#include <optional>
#include <string>
#include <string_view>

// The touchdown of a run: the verdict of telemetry/touchdown.hpp, with its figures and its place.
namespace aeolis::server {

// Names of the mission's dictionary.
inline constexpr std::array<std::string_view, 3> position_channels{"nav_position_x_m", "nav_position_y_m",
                                                                   "nav_position_z_m"};
/// The target in ground's solution: latitude, longitude, radius.
inline constexpr std::array<std::string_view, 3> target_arguments{"target_latitude_deg", "target_longitude_deg",
                                                                  "target_radius_m"};
/// What the vehicle holds of the error of its velocity: for a silence of its IMU alone.
inline constexpr std::string_view velocity_doubt_channel = "velocity_uncertainty_mps";
struct TouchdownChannel {
    std::string_view figure, channel;
};
inline constexpr std::array touchdown_channels{TouchdownChannel{"down", "descent_rate_mps"},
                                               TouchdownChannel{"across", "horizontal_speed_mps"},
                                               TouchdownChannel{"propellant left", "propellant_kg"}};

inline constexpr double touchdown_close_s = 2.0;  ///< chosen: an older sample is not the value at the touchdown

/// Converts a position from Mars's centre to east and north of the target, over ground. @param radius_m  of the target
v1::TouchdownPlace place_over_ground(const std::array<double, 3>& p_MoB_M, double latitude_deg, double longitude_deg,
                                     double radius_m);
/// What a place by navigation on board rests on. Nothing on board or on the ground holds its uncertainty, so none is
/// given.
/// @param velocity_doubt_mps  by the vehicle: for a silence of its IMU, 0 for none
std::string place_rests_on(std::optional<double> velocity_doubt_mps);
bool is_inside(const v1::TouchdownPlace& place, const v1::TargetEllipse& ellipse);

/// The touchdown of a run.
/// @param at        by what was received from the vehicle up to then; none: by all that is received
/// @param now       of the current run
/// @param recorded  whether the recording counts
Result<v1::TouchdownReport> touchdown(archive::Reader& reader, archive::RunId run,
                                      const dictionary::Dictionary& dictionary, std::optional<Sclk> at,
                                      std::optional<Ert> now, bool recorded);

}  // namespace aeolis::server
