// SPDX-License-Identifier: Apache-2.0
#include "simulation/limits.hpp"

#include "tests/simulation/gale.hpp"
#include "tests/support/catch.hpp"

namespace simulation_limits_test {

using namespace aeolis;
using namespace aeolis::simulation;

namespace {

LandingFigures soft() {
    LandingFigures figures;
    figures.outcome = Outcome::touchdown;
    figures.propellant_left_kg = 40.0;
    figures.touchdown = TouchdownReport{.vertical_mps = 0.75, .horizontal_mps = 0.1, .tilt_deg = 1.0};
    figures.parachute = ParachuteReport{1.75, 494.0};
    figures.separation = {{}, 300.0, nullptr};
    figures.least_timeline_margin_s = 2.0;
    return figures;
}

}  // namespace

TEST_CASE("a landing within its limits is landed", "[simulation][limits]") {
    const Judgement judgement = judge(Limits{}, soft());
    CHECK(judgement.verdict == Verdict::landed);
    CHECK(judgement.exceeded.empty());
    LandingFigures little;  // no parachute, nothing let go, no timeline: a landing of a test
    little.outcome = Outcome::touchdown;
    little.propellant_left_kg = 40.0;
    CHECK(judge(Limits{}, little).verdict == Verdict::landed);
}

TEST_CASE("each limit that a landing does not keep is told, with what it came to", "[simulation][limits]") {
    struct Case {
        const char* name;
        void (*spoil)(LandingFigures&);
    };
    const Case cases[] = {
        {"propellant_left_min_kg", [](LandingFigures& f) { f.propellant_left_kg = 3.9; }},
        {"touchdown_vertical_max_mps", [](LandingFigures& f) { f.touchdown->vertical_mps = 0.86; }},
        {"touchdown_horizontal_max_mps", [](LandingFigures& f) { f.touchdown->horizontal_mps = 0.51; }},
        {"touchdown_tilt_max_deg", [](LandingFigures& f) { f.touchdown->tilt_deg = 10.1; }},
        {"recontact_min_m", [](LandingFigures& f) { f.separation.heatshield_least_m = 24.9; }},
        {"recontact_min_m", [](LandingFigures& f) { f.separation.backshell_least_m = 24.9; }},
        {"parachute_mach_max", [](LandingFigures& f) { f.parachute->mach = 2.21; }},
        {"parachute_pressure_max_Pa", [](LandingFigures& f) { f.parachute->dynamic_pressure_Pa = 751.0; }},
        {"timeline_margin_min_s", [](LandingFigures& f) { f.least_timeline_margin_s = 0.4; }},
    };
    for (const Case& each : cases) {
        INFO(each.name);
        LandingFigures figures = soft();
        each.spoil(figures);
        const Judgement judgement = judge(Limits{}, figures);
        CHECK(judgement.verdict == Verdict::landed_outside_limits);
        REQUIRE(judgement.exceeded.size() == 1);
        CHECK(judgement.exceeded[0].name == std::string{each.name});
    }
    LandingFigures both = soft();
    both.touchdown->vertical_mps = 0.91;
    both.propellant_left_kg = 1.2;
    CHECK(text_of(judge(Limits{}, both).exceeded) == "propellant_left_min_kg 1.2 instead of at least 4; "
                                                     "touchdown_vertical_max_mps 0.91 instead of at most 0.85");
}

TEST_CASE("the limits are the scenario's: what one allows another does not", "[simulation][limits]") {
    LandingFigures figures = soft();
    Limits strict;
    strict.propellant_left_min_kg = 50.0;
    CHECK(judge(strict, figures).verdict == Verdict::landed_outside_limits);
    Scenario scenario = tests::gale_scenario();
    scenario.limits.parachute_mach_max = 7.0;
    const auto found = impossible_values(scenario);
    REQUIRE(found.size() == 1);
    CHECK(found[0] == "limits.parachute_mach_max: 7 is outside 0 … 5");
}

TEST_CASE("what did not land is lost, whatever its figures; what flies is not judged", "[simulation][limits]") {
    LandingFigures figures = soft();
    for (const Outcome outcome : {Outcome::impact, Outcome::lost, Outcome::not_commanded, Outcome::timeout}) {
        figures.outcome = outcome;
        CHECK(judge(Limits{}, figures).verdict == Verdict::lost);
    }
    figures.outcome = Outcome::running;
    CHECK(judge(Limits{}, figures).verdict == Verdict::flying);
}

}  // namespace simulation_limits_test
