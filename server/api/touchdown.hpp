// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/prediction.pb.h"
#include "aeolis/v1/touchdown.pb.h"
#include "server/archive/reader.hpp"

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// The touchdown in the three signals that flown landings used: the vehicle tells it, the rover's own IMU is still, UHF
// goes on without a break [steltzner-2012]. It is reported until all three are there, then confirmed. The bounds are
// not published: chosen here.
namespace aeolis::server {

// The names of the mission by which a touchdown is told. A dictionary without them has no touchdown.
inline constexpr std::string_view touchdown_timepoint = "touchdown", touchdown_event = "TOUCHDOWN",
                                  touchdown_flag = "touchdown_declared", touchdown_live = "edl_phase";
inline constexpr std::array<std::string_view, 3> position_channels{"nav_position_x_m", "nav_position_y_m",
                                                                   "nav_position_z_m"};
/// Of the ground's solution: latitude, longitude, radius.
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

/// Of the rover's own IMU, in one packet.
inline constexpr std::string_view rover_rate_channel = "rover_imu_rate_rps",
                                  rover_force_channel = "rover_imu_force_mps2";

/// What counts as still: a rate and a specific force within these bounds, for so long without a gap.
inline constexpr double still_s = 10.0;  ///< chosen: longer than a swing on the bridle, 9 s, which rests at its ends
inline constexpr double still_rate_max_rps = 0.005;  ///< chosen: the unit's noise stays below; a swing of 0.5° does not
inline constexpr double still_weight_mps2 = 3.71;    ///< [facts] Mars
inline constexpr double still_weight_within_mps2 = 0.1;  ///< chosen: its noise is 0.02, sites differ by as much

inline constexpr double touchdown_uhf_s = 10.0;   ///< chosen: half of what is planned
inline constexpr double touchdown_gap_s = 3.0;    ///< chosen: the channel that is looked at comes each second
inline constexpr double touchdown_close_s = 2.0;  ///< chosen: an older sample is not the value at the touchdown

/// What had been received by an instant. Times by the vehicle's clock.
struct TouchdownFacts {
    struct Told {
        Sclk sclk;
        std::string words;  ///< "timepoint touchdown by UHF"
    };
    struct Flag {
        Sclk sclk;
        double value = 0.0;
    };
    struct RoverImu {
        Sclk sclk;
        double rate_rps = 0.0, force_mps2 = 0.0;
    };
    struct Silence {
        Sclk from;
        std::optional<Sclk> to;  ///< none: it goes on
        std::string words;
    };
    Sclk entry, now;
    std::vector<Told> told;           ///< in any order
    std::string flag_name;            ///< of the channel that tells it
    std::optional<Flag> flag;         ///< its newest sample
    bool rover_imu_known = false;     ///< the dictionary has its channels
    std::vector<RoverImu> rover_imu;  ///< what it told, by time
    std::string live_name;            ///< of the channel whose samples show that UHF comes
    std::vector<Sclk> live;           ///< its samples over UHF, by time
    std::vector<Silence> silences;    ///< of UHF, by time
};

/// Verdict, time and steps. Untold without `told`.
v1::TouchdownReport judge_touchdown(const TouchdownFacts& facts);

/// East and north of the target, over ground, of a place from Mars's centre. @param radius_m  of the target
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
