#include "flight/edl_comm/telemetry_plan.hpp"

namespace aeolis::flight {
namespace {

// Recorded rates are those of edl/edl_telemetry.cpp. In octets a second this comes to about 500 of the link's 1000; the
// rest is for events, firings and explanations, which come in bursts.
struct Row {
    Apid apid;
    std::uint32_t before_entry;
    std::uint32_t entry;
    std::uint32_t descent;
};

constexpr Row mission_plan[] = {
    {packet::EdlStatus::apid, 2, 2, 2},       {packet::TimelineStatus::apid, 2, 4, 4},
    {packet::CommStatus::apid, 10, 10, 10},   {packet::SyncStatus::apid, 10, 10, 10},
    {packet::GncNavigation::apid, 1, 32, 32}, {packet::GncEntry::apid, 8, 8, 0},
    {packet::GncImu::apid, 8, 4, 4},          {packet::GncDescent::apid, 0, 0, 4},
    {packet::GncRadar::apid, 0, 0, 1},
};

}  // namespace

bool goes_first(Apid apid) {
    return apid == evr::COMMAND_ACCEPTED::apid || apid == packet::TimepointFired::apid ||
           apid == packet::Explanation::apid || apid == packet::ToneSelected::apid ||
           apid == packet::ParametersHeld::apid;
}

std::uint32_t realtime_every(Plan plan, EdlPhase phase, Apid apid) {
    if (plan == Plan::wideband && apid == packet::Wideband::apid) return 1;
    for (const Row& row : mission_plan) {
        if (row.apid != apid) continue;
        if (phase < EdlPhase::wait_for_guidance) return row.before_entry;
        return phase < EdlPhase::parachute_descent ? row.entry : row.descent;
    }
    return 0;
}

}  // namespace aeolis::flight
