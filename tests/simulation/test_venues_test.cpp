// SPDX-License-Identifier: Apache-2.0
#include "commands/encoder.hpp"
#include "common/space_packet.hpp"
#include "flight/edl/solution.hpp"
#include "server/rehearsal/scripted_landing.hpp"
#include "simulation/landing.hpp"
#include "simulation/venues/gnc_alone.hpp"
#include "simulation/venues/gnc_stand_in.hpp"
#include "simulation/venues/venue_timeline.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/recorded_events.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/telecommands.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

namespace simulation_test_venues_test {

using namespace aeolis;
using namespace aeolis::simulation;

namespace {

Scenario in_venue(TestVenue venue, double start_before_entry_s) {
    Scenario scenario = tests::gale_scenario(start_before_entry_s);
    scenario.test_venue = venue;
    return scenario;
}

void fly_to_the_end(Landing& landing, std::set<std::string>& events) {
    while (landing.outcome() == Outcome::running)
        for (const TruthEvent& event : landing.step().events) events.insert(event.name);
    INFO(landing.outcome_reason());
    REQUIRE(landing.outcome() == Outcome::touchdown);
    CHECK(landing.touchdown()->vertical_mps < 0.9);
    CHECK(landing.touchdown()->horizontal_mps < 0.5);
}

}  // namespace

TEST_CASE("in the venue GNC alone a landing needs no computer: nothing is recorded, and GNC's decisions are told",
          "[venue][R36]") {
    Landing landing{in_venue(TestVenue::gnc_alone, 620.0), 1};
    std::set<std::string> events;
    fly_to_the_end(landing, events);
    CHECK(landing.recording().empty());
    CHECK(landing.counters().cycles == 0);
    for (const char* name : decided_on_board) CHECK(events.count(name) == 1);
}

TEST_CASE("in the venue all but GNC the whole timeline fires around a stand-in that sees the truth", "[venue][R36]") {
    Landing landing{in_venue(TestVenue::all_but_gnc, 900.0), 1};
    landing.uplink(test::set_parameters(landing.solution()));
    for (int tick = 0; tick < 64; ++tick) landing.step();
    landing.uplink(test::do_edl());
    std::set<std::string> events;
    fly_to_the_end(landing, events);
    CHECK(landing.counters().overruns == 0);
    CHECK(tests::count_recorded<flight::evr::TIMELINE_COMPLETE>(landing.recording()) == 1);
    CHECK(tests::count_recorded<flight::evr::PARACHUTE_DEPLOY>(landing.recording()) == 1);
    CHECK(tests::count_recorded<flight::evr::BANK_REVERSAL>(landing.recording()) == 3);
    CHECK(tests::count_recorded<flight::evr::TIMEPOINT_UNVERIFIED>(landing.recording()) == 0);
    CHECK(tests::count_recorded<flight::evr::TIMEPOINT_REFUSED>(landing.recording()) == 0);
}

TEST_CASE("venues are dispersed alike: another case is another landing, the same one the same bits",
          "[venue][R36][invariant1]") {
    struct Flown {
        double longitude_deg = 0.0;
        std::array<double, 3> started_M_m{};
        bool operator==(const Flown&) const = default;
    };
    const auto fly = [](TestVenue venue, std::uint64_t case_number) {
        Landing landing{in_venue(venue, 900.0), 3, case_number};
        Flown flown;
        flown.started_M_m = landing.truth().p_MoB_M_m;
        if (venue == TestVenue::all_but_gnc) {
            landing.uplink(test::set_parameters(landing.solution()));
            for (int tick = 0; tick < 64; ++tick) landing.step();
            landing.uplink(test::do_edl());
        }
        while (landing.outcome() == Outcome::running) landing.step();
        INFO(landing.outcome_reason());
        REQUIRE(landing.outcome() == Outcome::touchdown);
        flown.longitude_deg = landing.touchdown()->longitude_deg;
        return flown;
    };
    const Flown gnc = fly(TestVenue::gnc_alone, 1), all_but_gnc = fly(TestVenue::all_but_gnc, 1);
    CHECK(fly(TestVenue::gnc_alone, 1) == gnc);
    CHECK(fly(TestVenue::all_but_gnc, 1) == all_but_gnc);
    // The same case is the same vehicle whoever flies it.
    CHECK(gnc.started_M_m == all_but_gnc.started_M_m);
    CHECK(fly(TestVenue::gnc_alone, 2).longitude_deg != gnc.longitude_deg);
    CHECK(fly(TestVenue::all_but_gnc, 2).longitude_deg != all_but_gnc.longitude_deg);
}

TEST_CASE("a fork of a landing in a venue of its own goes on alike", "[venue][R36][invariant2]") {
    for (const TestVenue venue : {TestVenue::gnc_alone, TestVenue::all_but_gnc}) {
        Landing landing{in_venue(venue, 620.0), 1};
        for (int tick = 0; tick < 64 * 200; ++tick) landing.step();
        Landing fork{landing};
        for (int tick = 0; tick < 64 * 30; ++tick) {
            landing.step();
            fork.step();
        }
        CHECK(fork.truth().p_MoB_M_m == landing.truth().p_MoB_M_m);
        CHECK(fork.recording().size() == landing.recording().size());
    }
}

TEST_CASE("who takes no commands is given none: a scenario that tries is refused", "[venue][R36][scenario]") {
    Scenario scenario = in_venue(TestVenue::gnc_alone, 620.0);
    CHECK(impossible_values(scenario).empty());
    scenario.commands.push_back({600.0, "EDL_DO_EDL", {}, false});
    REQUIRE(impossible_values(scenario).size() == 1);
    CHECK_THAT(impossible_values(scenario)[0], Catch::StartsWith("commands: in the test venue gnc_alone"));
}

TEST_CASE("the lines in place of the timeline stand where the shipped timeline has them", "[venue][R36]") {
    const auto& dictionary = tests::shipped_dictionary();
    using flight::gnc::Trigger;
    const auto anchor_of = [](std::optional<Trigger> after) -> std::string {
        if (!after) return "entry";
        switch (*after) {
        case Trigger::guidance_start: return "guidance_start";
        case Trigger::sufr_start: return "sufr_start";
        case Trigger::parachute: return "parachute";
        case Trigger::heatshield: return "heatshield";
        case Trigger::engine_priming: return "priming";
        case Trigger::backshell: return "backshell";
        case Trigger::sky_crane: return "sky_crane";
        case Trigger::rover_separation: return "rover_separation";
        case Trigger::touchdown: return "touchdown";
        default: return "no anchor";
        }
    };
    for (const VenueTimeline::Line& line : VenueTimeline::lines()) {
        INFO(line.timepoint);
        const auto named = std::ranges::find(dictionary.timeline, line.timepoint, &dictionary::TimelineRow::name);
        REQUIRE(named != dictionary.timeline.end());
        // A row without an anchor counts from the row before it.
        double offset_s = *named->desired_offset_s;
        auto row = named;
        while (!row->anchor) {
            REQUIRE(row != dictionary.timeline.begin());
            --row;
            offset_s += *row->desired_offset_s;
        }
        auto anchor = std::ranges::find(dictionary.anchors, *row->anchor, &dictionary::AnchorRow::id);
        REQUIRE(anchor != dictionary.anchors.end());
        while (anchor->parent && anchor->offset_s) {  // it is at a fixed time from its parent
            offset_s += *anchor->offset_s;
            anchor = std::ranges::find(dictionary.anchors, *anchor->parent, &dictionary::AnchorRow::id);
        }
        CHECK(anchor->name == anchor_of(line.after));
        CHECK(offset_s == line.offset_s);
    }
}

TEST_CASE("GNC alone navigates from what a computer makes of the shipped command with the same solution",
          "[venue][R36]") {
    const Landing landing{in_venue(TestVenue::gnc_alone, 620.0), 5};
    const auto* command = tests::shipped_dictionary().command("EDL_SET_PARAMETERS");
    REQUIRE(command != nullptr);
    // Arguments that the solution does not bring keep the dictionary's initial values.
    const auto packet = commands::encode(*command, server::solution_arguments(landing.solution()), 0);
    REQUIRE(packet);
    const auto commanded = flight::command::EDL_SET_PARAMETERS::decode(read_tc_packet(*packet)->arguments);
    REQUIRE(commanded);
    auto expected = flight::solution_of(*commanded);
    auto alone = solution_of(landing.solution());
    CHECK(alone.epoch == expected.epoch);
    CHECK(alone.p_MoB_M_m == expected.p_MoB_M_m);
    CHECK(alone.v_MB_M_mps == expected.v_MB_M_mps);
    CHECK(alone.entry == expected.entry);
    CHECK(alone.target_latitude_rad == Approx(expected.target_latitude_rad));
    CHECK(alone.target_longitude_rad == Approx(expected.target_longitude_rad));
    CHECK(alone.target_radius_m == expected.target_radius_m);
    // These are four octets wide in the command.
    CHECK(alone.parachute_speed_mps == Approx(expected.parachute_speed_mps));
    CHECK(alone.parachute_altitude_min_m == Approx(expected.parachute_altitude_min_m));
    CHECK(alone.heatshield_speed_mps == Approx(expected.heatshield_speed_mps));
    CHECK(alone.backshell_altitude_m == Approx(expected.backshell_altitude_m));
    CHECK(alone.backshell_descent_rate_mps == Approx(expected.backshell_descent_rate_mps));
}

TEST_CASE("each line in place of the timeline happens once, at its time, and waits for its trigger", "[venue][R36]") {
    VenueTimeline timeline{Sclk{1000.0}};
    flight::DeviceOutputs out;
    const auto at = [&](double e_s) {
        out.begin_cycle();
        timeline.act(Sclk{1000.0 + e_s}, out);
    };
    at(-700.0);
    CHECK(out.pyros.empty());
    for (const auto& [e_s, pyro] :
         {std::pair{-608.0, flight::PyroId::cruise_cable_cutter},
          std::pair{-600.046875, flight::PyroId::cruise_stage_separation},
          std::pair{-489.0, flight::PyroId::cruise_balance_1}, std::pair{-488.0, flight::PyroId::cruise_balance_2}}) {
        INFO(e_s);
        at(e_s - seconds_per_tick);
        CHECK(out.pyros.empty());
        at(e_s);
        REQUIRE(out.pyros.size() == 1);
        CHECK(out.pyros[0].id == pyro);
    }
    at(-300.0 - seconds_per_tick);
    CHECK_FALSE(timeline.configuration().guidance_armed);
    at(-300.0);
    CHECK(timeline.configuration().guidance_armed);
    at(100.0);
    CHECK(out.pyros.empty());
    CHECK_FALSE(timeline.configuration().parachute_out);
    flight::gnc::Output told;
    told.triggers.push_back({flight::gnc::Trigger::parachute, {}});
    timeline.take(told, Sclk{1100.0});
    at(100.0);
    CHECK(timeline.configuration().parachute_out);
    REQUIRE(out.pyros.size() == 1);
    CHECK(out.pyros[0].id == flight::PyroId::parachute_mortar);
    at(100.0 + seconds_per_tick);
    CHECK(out.pyros.empty());
}

}  // namespace simulation_test_venues_test
