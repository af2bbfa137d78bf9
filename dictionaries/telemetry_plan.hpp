#pragma once

#include "common/ids.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

// telemetry_plan.csv: what of the recording goes to ground in real time, by the state of the vehicle. R30
namespace aeolis::dictionary {

/// Least important first; the words of the sheet.
enum class TelemetryPriority { low, normal, high, first };
inline constexpr std::array<std::string_view, 4> telemetry_priority_words{"low", "normal", "high", "first"};

/// The states of the vehicle that a plan tells apart: columns of the sheet.
inline constexpr std::array<std::string_view, 4> telemetry_state_columns{"before_entry", "entry", "descent", "landed"};

/// One packet in one plan.
struct TelemetryPlanRow {
    std::string plan;    ///< name of an enumerator of flight's Plan; "all": every plan of the sheet
    std::string packet;  ///< of the dictionary; "events": the event reports, which share an APID
    Apid apid;
    TelemetryPriority priority = TelemetryPriority::low;
    std::array<std::uint32_t, telemetry_state_columns.size()> every{}; ///< every n-th packet in that state; 0: none
    std::string note;
    unsigned line = 0; ///< in telemetry_plan.csv
};

} // namespace aeolis::dictionary
