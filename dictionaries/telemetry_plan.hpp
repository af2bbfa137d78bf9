// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ids.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

// telemetry_plan.csv: the rate at which each packet is recorded, and the part of it that is sent in real time in each
// state of the vehicle.
// R30, R52
namespace aeolis::dictionary {

/// Priority of a packet, least important first; the words used in the sheet.
enum class TelemetryPriority { low, normal, high, first };
inline constexpr std::array<std::string_view, 4> telemetry_priority_words{"low", "normal", "high", "first"};

/// States of the vehicle that a plan distinguishes; columns of the sheet.
inline constexpr std::array<std::string_view, 4> telemetry_state_columns{"before_entry", "entry", "descent", "landed"};

/// The phases of EDL (labels of the XTCE enumeration EdlPhase), and the column of each.
inline constexpr std::array<std::pair<std::string_view, std::size_t>, 15> telemetry_state_of_phase{
    {{"pre_edl", 0},
     {"late_cruise", 0},
     {"edl_approach", 0},
     {"edl_main", 0},
     {"exo_atmospheric", 0},
     {"wait_for_guidance", 1},
     {"range_control", 1},
     {"heading_alignment", 1},
     {"straighten_up", 1},
     {"wait_for_parachute", 1},
     {"parachute_descent", 2},
     {"powered_descent", 2},
     {"sky_crane", 2},
     {"flyaway", 2},
     {"landed", 3}}};

/// One packet in one plan.
struct TelemetryPlanRow {
    std::string plan;    ///< name of an enumerator of flight's Plan; "all": every plan of the sheet
    std::string packet;  ///< of the dictionary; "events": the event reports, which share an APID
    Apid apid;
    TelemetryPriority priority = TelemetryPriority::low;
    std::array<std::uint32_t, telemetry_state_columns.size()> every{};  ///< every n-th packet in that state; 0: none
    std::uint32_t recorded_hz = 0;  ///< highest rate at which it is recorded; 0: on occasion
    std::string note;
    unsigned line = 0;  ///< in telemetry_plan.csv
};

}  // namespace aeolis::dictionary
