// SPDX-License-Identifier: Apache-2.0
#include "flight/edl_comm/telemetry_plan.hpp"

namespace aeolis::flight {
namespace {

constexpr TelemetryPlanRow recorded_only{std::nullopt, Apid{}, TelemetryPriority::low, {}};

}  // namespace

const TelemetryPlanRow& planned(Plan plan, Apid apid) {
    for (const TelemetryPlanRow& row : telemetry_plan_rows)
        if (row.apid == apid && row.plan.value_or(plan) == plan) return row;
    return recorded_only;
}

std::uint32_t every_in(const TelemetryPlanRow::Every& every, EdlPhase phase) {
    switch (phase) {
    case EdlPhase::pre_edl:
    case EdlPhase::late_cruise:
    case EdlPhase::edl_approach:
    case EdlPhase::edl_main:
    case EdlPhase::exo_atmospheric: return every.before_entry;
    case EdlPhase::wait_for_guidance:
    case EdlPhase::range_control:
    case EdlPhase::heading_alignment:
    case EdlPhase::straighten_up:
    case EdlPhase::wait_for_parachute: return every.entry;
    case EdlPhase::parachute_descent:
    case EdlPhase::powered_descent:
    case EdlPhase::sky_crane:
    case EdlPhase::flyaway: return every.descent;
    case EdlPhase::landed: return every.landed;
    }
    return 0;
}

}  // namespace aeolis::flight
