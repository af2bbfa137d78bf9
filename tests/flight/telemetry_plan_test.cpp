#include "flight/edl_comm/telemetry_plan.hpp"

#include "tests/support/catch.hpp"

using namespace aeolis;
using namespace aeolis::flight;

TEST_CASE("the synthetic load goes out whole in its own plan and not at all in the mission's", "[telemetry_plan][R30]") {
    CHECK(realtime_every(Plan::wideband, EdlPhase::late_cruise, packet::Wideband::apid) == 1);
    CHECK(realtime_every(Plan::mission, EdlPhase::late_cruise, packet::Wideband::apid) == 0);
}

TEST_CASE("events, firings, explanations and tones are never thinned", "[telemetry_plan][R30]") {
    CHECK(goes_first(evr::COMMAND_ACCEPTED::apid));
    CHECK(goes_first(packet::TimepointFired::apid));
    CHECK(goes_first(packet::Explanation::apid));
    CHECK(goes_first(packet::ToneSelected::apid));
    CHECK_FALSE(goes_first(packet::GncNavigation::apid));
}
