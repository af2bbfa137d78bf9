// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// The touchdown, by the three signals that flown landings used: the vehicle reports it, the rover's own IMU is at rest,
// and UHF continues without a break [steltzner-2012]. It counts as reported until all three are there, then as
// confirmed. The bounds are not published; they are chosen here.
namespace aeolis::telemetry {

// Names of the mission's dictionary that report a touchdown. A dictionary without them has no touchdown.
inline constexpr std::string_view touchdown_timepoint = "touchdown", touchdown_event = "TOUCHDOWN",
                                  touchdown_flag = "touchdown_declared", touchdown_live = "edl_phase";

/// Of the rover's own IMU, in one packet.
inline constexpr std::string_view rover_rate_channel = "rover_imu_rate_rps",
                                  rover_force_channel = "rover_imu_force_mps2";

/// What counts as still: a rate and a specific force within these bounds, for so long without a gap.
inline constexpr double still_s = 10.0;  ///< chosen: longer than a swing on the bridle, 9 s, which rests at its ends
inline constexpr double still_rate_max_rps = 0.005;  ///< chosen: the unit's noise stays below; a swing of 0.5° does not
inline constexpr double still_weight_mps2 = 3.71;    ///< [facts] Mars
inline constexpr double still_weight_within_mps2 = 0.1;  ///< chosen: its noise is 0.02, sites differ by as much

inline constexpr double touchdown_uhf_s = 10.0;  ///< chosen: half of what is planned
inline constexpr double touchdown_gap_s = 3.0;   ///< chosen: the channel used here is sent each second

/// The facts received by an instant. Times are by the vehicle's clock.
struct TouchdownFacts {
    struct Report {
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
    Sclk entry;  ///< 0: nobody knows it
    Sclk now;
    std::vector<Report> told;         ///< in any order
    std::string flag_name;            ///< of the channel that tells it
    std::optional<Flag> flag;         ///< its newest sample
    bool rover_imu_known = false;     ///< the dictionary has its channels
    std::vector<RoverImu> rover_imu;  ///< what it told, by time
    std::string live_name;            ///< of the channel whose samples show that UHF comes
    std::vector<Sclk> live;           ///< its samples over UHF, by time
    std::vector<Silence> silences;    ///< of UHF, by time
};

/// Numbers equal those of the schema.
enum class TouchdownVerdict : std::uint8_t {
    untold,        ///< nothing has told of it
    reported,      ///< not all signals are there
    confirmed,     ///< all are
    contradicted,  ///< one source says yes, a newer one no
};

/// One of the signals that together confirm a touchdown.
struct TouchdownStep {
    /// Numbers equal those of the schema.
    enum class State : std::uint8_t {
        done,
        waiting,  ///< what would tell it comes, and does not tell it yet
        unknown,  ///< what would tell it does not come
        never,    ///< this vehicle sends nothing that would tell it
        contradicted,
    };
    std::string name;
    State state{};
    std::string words;            ///< the evidence, with its times
    std::optional<Sclk> since{};  ///< from when on it holds
};

struct TouchdownJudgement {
    TouchdownVerdict verdict{};
    Sclk sclk;                         ///< when it was, as first told; 0: untold
    std::vector<TouchdownStep> steps;  ///< none: untold
};

/// Judges the touchdown. Without `told` it is not reported.
TouchdownJudgement judge_touchdown(const TouchdownFacts& facts);

}  // namespace aeolis::telemetry
