// SPDX-License-Identifier: Apache-2.0
#include "flight/edl_comm/telemetry_plan.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

namespace flight_telemetry_plan_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

std::uint32_t every(Plan plan, EdlPhase phase, Apid apid) {
    return every_in(planned(plan, apid).every, phase);
}

}  // namespace

TEST_CASE("the synthetic load goes out whole in its own plan and not at all in the mission's",
          "[telemetry_plan][R30]") {
    CHECK(every(Plan::wideband, EdlPhase::late_cruise, packet::Wideband::apid) == 1);
    CHECK(every(Plan::mission, EdlPhase::late_cruise, packet::Wideband::apid) == 0);
}

TEST_CASE("events, firings, explanations and tones are never thinned, in any state", "[telemetry_plan][R30]") {
    for (const Apid apid : {evr::COMMAND_ACCEPTED::apid, packet::TimepointFired::apid, packet::Explanation::apid,
                            packet::ToneSelected::apid, packet::ParametersHeld::apid})
        for (int phase = 0; phase <= static_cast<int>(EdlPhase::flyaway); ++phase) {
            CHECK(every(Plan::mission, static_cast<EdlPhase>(phase), apid) == 1);
            CHECK(planned(Plan::mission, apid).priority == TelemetryPriority::first);
        }
    CHECK(planned(Plan::mission, packet::GncNavigation::apid).priority < TelemetryPriority::first);
}

TEST_CASE("what flight plans is what the sheet says, packet by packet and state by state",
          "[telemetry_plan][R30][R40][R48]") {
    constexpr std::array states{EdlPhase::exo_atmospheric, EdlPhase::range_control, EdlPhase::sky_crane,
                                EdlPhase::landed};
    for (const auto& row : tests::shipped_dictionary().telemetry_plan) {
        INFO(row.packet);
        const Plan plan = row.plan == "wideband" ? Plan::wideband : Plan::mission;
        for (std::size_t state = 0; state < states.size(); ++state)
            CHECK(every(plan, states[state], row.apid) == row.every[state]);
        CHECK(static_cast<int>(planned(plan, row.apid).priority) == static_cast<int>(row.priority));
    }
}

TEST_CASE("ground tells the state of the vehicle from the phase as flight does", "[telemetry_plan][R30]") {
    const TelemetryPlanRow::Every by_column{0, 1, 2, 3};
    const auto& phase = tests::shipped_dictionary().channel("edl_phase")->type;
    REQUIRE(phase.enumeration.size() == dictionary::telemetry_state_of_phase.size());
    for (const auto& [label, column] : dictionary::telemetry_state_of_phase) {
        INFO(label);
        const auto found = std::ranges::find(phase.enumeration, label, &dictionary::EnumValue::label);
        REQUIRE(found != phase.enumeration.end());
        CHECK(every_in(by_column, static_cast<EdlPhase>(found->value)) == column);
    }
}

TEST_CASE("a packet that no plan knows is recorded only", "[telemetry_plan][R30]") {
    CHECK(every(Plan::mission, EdlPhase::range_control, Apid{0x7FE}) == 0);
    CHECK(planned(Plan::mission, Apid{0x7FE}).priority == TelemetryPriority::low);
}

}  // namespace flight_telemetry_plan_test
