#include "simulation/landing.hpp"
#include "simulation/venues/gnc_alone.hpp"
#include "simulation/venues/gnc_stand_in.hpp"
#include "simulation/venues/venue_timeline.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/recorded_events.hpp"
#include "tests/support/telecommands.hpp"

#include <set>

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
        for (const TruthEvent& event : landing.step().events)
            events.insert(event.name);
    INFO(landing.outcome_reason());
    REQUIRE(landing.outcome() == Outcome::touchdown);
    CHECK(landing.touchdown()->vertical_mps < 0.9);
    CHECK(landing.touchdown()->horizontal_mps < 0.5);
}

} // namespace

TEST_CASE("in the venue GNC alone a landing needs no computer: nothing is recorded, and GNC's decisions are told",
          "[venue][R36]") {
    Landing landing{in_venue(TestVenue::gnc_alone, 620.0), 1};
    std::set<std::string> events;
    fly_to_the_end(landing, events);
    CHECK(landing.recording().empty());
    CHECK(landing.counters().cycles == 0);
    for (const char* name : decided_on_board)
        CHECK(events.count(name) == 1);
}

TEST_CASE("in the venue all but GNC the whole timeline fires around a stand-in that sees the truth", "[venue][R36]") {
    Landing landing{in_venue(TestVenue::all_but_gnc, 900.0), 1};
    landing.uplink(test::set_parameters(landing.solution()));
    for (int tick = 0; tick < 64; ++tick)
        landing.step();
    landing.uplink(test::do_edl());
    std::set<std::string> events;
    fly_to_the_end(landing, events);
    CHECK(landing.counters().overruns == 0);
    CHECK(tests::count_recorded<flight::evr::TIMELINE_COMPLETE>(landing.recording()) == 1);
    CHECK(tests::count_recorded<flight::evr::PARACHUTE_DEPLOY>(landing.recording()) == 1);
    CHECK(tests::count_recorded<flight::evr::BANK_REVERSAL>(landing.recording()) == 3);
    CHECK(tests::count_recorded<flight::evr::TIMEPOINT_TIMED_OUT>(landing.recording()) == 0);
}

TEST_CASE("venues are dispersed alike: another case is another landing, the same one the same bits", "[venue][R36][invariant1]") {
    const auto touchdown = [](TestVenue venue, std::uint64_t case_number) {
        Landing landing{in_venue(venue, 620.0), 3, case_number};
        if (venue == TestVenue::all_but_gnc) {
            landing.uplink(test::set_parameters(landing.solution()));
            landing.step();
            landing.uplink(test::do_edl());
        }
        while (landing.outcome() == Outcome::running)
            landing.step();
        REQUIRE(landing.outcome() == Outcome::touchdown);
        return landing.touchdown()->longitude_deg;
    };
    const double first = touchdown(TestVenue::gnc_alone, 1);
    CHECK(touchdown(TestVenue::gnc_alone, 1) == first);
    CHECK(touchdown(TestVenue::gnc_alone, 2) != first);
}

TEST_CASE("a fork of a landing in a venue of its own goes on alike", "[venue][R36][invariant2]") {
    for (const TestVenue venue : {TestVenue::gnc_alone, TestVenue::all_but_gnc}) {
        Landing landing{in_venue(venue, 620.0), 1};
        for (int tick = 0; tick < 64 * 200; ++tick)
            landing.step();
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

TEST_CASE("the lines in place of the timeline happen once each, in order, and wait for their trigger", "[venue][R36]") {
    VenueTimeline timeline{Sclk{1000.0}};
    flight::DeviceOutputs out;
    timeline.act(Sclk{1000.0 - 700.0}, out);
    CHECK(out.switches.empty());
    timeline.act(Sclk{1000.0 - 300.0}, out);
    CHECK(timeline.configuration().guidance_armed);
    CHECK(out.pyros.size() == 4); // cables, cruise stage, two balance masses
    out.begin_cycle();
    timeline.act(Sclk{1100.0}, out);
    CHECK(out.pyros.empty());
    CHECK_FALSE(timeline.configuration().parachute_out);
    flight::gnc::Output told;
    told.triggers.push_back(flight::gnc::Trigger::parachute);
    timeline.take(told, Sclk{1100.0});
    timeline.act(Sclk{1100.0}, out);
    CHECK(timeline.configuration().parachute_out);
    CHECK(out.pyros.size() == 1);
}
