// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ids.hpp"
#include "flight/load.hpp"
#include "generated/dictionary_flight.hpp"

#include <cstdint>
#include <optional>
#include <span>

// What of the recording goes to ground in real time, and what of it first: dictionaries/msl/telemetry_plan.csv, as the
// autocoder wrote it. R30
namespace aeolis::flight {

/// Least important first. What goes `first` is never thinned, and the last of the recording is kept for it.
enum class TelemetryPriority : std::uint8_t { low, normal, high, first };
inline constexpr std::size_t telemetry_priorities = 4;

/// A row of the sheet: every n-th packet of an APID in each state of the vehicle that a plan tells apart; 0: none.
struct TelemetryPlanRow {
    struct Every {
        std::uint32_t before_entry;
        std::uint32_t entry;
        std::uint32_t descent;
        std::uint32_t landed;
    };
    std::optional<Plan> plan;  ///< none: every plan
    Apid apid;
    TelemetryPriority priority{};
    Every every{};
};
extern const std::span<const TelemetryPlanRow> telemetry_plan_rows;

/// The row that says what becomes of packets of that APID; of an APID that the dictionary lacks: recorded only.
const TelemetryPlanRow& planned(Plan plan, Apid apid);

std::uint32_t every_in(const TelemetryPlanRow::Every& every, EdlPhase phase);

}  // namespace aeolis::flight
