// SPDX-License-Identifier: Apache-2.0
#include "server/shadow/forecast.hpp"

#include "server/campaign/case_flights.hpp"
#include "server/scenario/scenario_text.hpp"
#include "server/shadow/forecast_report.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>

namespace server_shadow_forecast_test {

using namespace aeolis;
using namespace aeolis::server;
using namespace aeolis::server::shadow;

namespace {

simulation::Scenario shipped(const char* name) {
    auto scenario = scenario_from_file(std::string{AEOLIS_SOURCE_DIR "/simulation/scenarios/"} + name + ".textproto");
    REQUIRE(scenario);
    return *scenario;
}

ScriptedLanding flown_to(const simulation::Scenario& scenario, double e_s) {
    ScriptedLanding landing{scenario, 1, 0, tests::shipped_dictionary()};
    while (landing.landing().truth().e_s < e_s) {
        landing.hear(landing.step());
        landing.take_stages();
    }
    return landing;
}

/// The landing of nominal_auto 20 s before entry, flown once for all tests of this file.
const ScriptedLanding& before_entry() {
    static const ScriptedLanding landing = flown_to(shipped("nominal_auto"), -20.0);
    return landing;
}

const std::atomic<bool> never{false};

Result<FlownForecast> forecast(const ScriptedLanding& landing, const simulation::Scenario& scenario,
                               const Assumption& assumption, std::uint64_t cases, unsigned jobs,
                               std::uint64_t seed = 1) {
    return forecast_from_truth(landing, scenario, tests::shipped_dictionary(), assumption,
                               {.seed = seed, .cases = cases, .jobs = jobs}, never);
}

/// What a forecast says, without the times that it took.
std::string said(const FlownForecast& forecast) {
    FlownForecast timeless = forecast;
    timeless.wall_s = timeless.processor_s = 0.0;
    return forecast_json(timeless, shipped("nominal_auto").limits, {});
}

Assumption prime_fails() {
    Assumption assumption;
    assumption.faults.emplace_back(simulation::ComputerReset{});
    return assumption;
}

commands::Request command(std::string name) {
    commands::Request request;
    request.command = std::move(name);
    request.armed = true;
    request.confirmation = request.command;
    return request;
}

}  // namespace

TEST_CASE("a forecast is the same by one thread and by two, and another by another seed", "[shadow][R58]") {
    const auto scenario = shipped("nominal_auto");
    const auto one = forecast(before_entry(), scenario, prime_fails(), 2, 1);
    const auto two = forecast(before_entry(), scenario, prime_fails(), 2, 2);
    REQUIRE(one);
    REQUIRE(two);
    CHECK(said(*one) == said(*two));
    for (std::size_t i = 0; i < 2; ++i) CHECK(one->without[i].number == i + 1);
    const auto other = forecast(before_entry(), scenario, {}, 1, 1, 2);
    REQUIRE(other);
    CHECK(other->without[0].touchdown->miss_m != one->without[0].touchdown->miss_m);
}

TEST_CASE("with a fault that ground did not provide for no case lands, without it each does; with Second Chance "
          "enabled they do",
          "[shadow][R58]") {
    const auto scenario = shipped("nominal_auto");
    const auto flown = forecast(before_entry(), scenario, prime_fails(), 2, 2);
    REQUIRE(flown);
    const auto landed = [](const std::vector<campaign::CaseResult>& cases) {
        return std::ranges::count(cases, "touchdown", &campaign::CaseResult::outcome);
    };
    CHECK(landed(flown->without) == 2);
    CHECK(landed(flown->with) == 0);
    const Pairs pairs = pairs_of(flown->without, flown->with);
    CHECK(pairs.only_without == 2);
    const auto provided = flown_to(shipped("second_chance"), -20.0);
    const auto survived = forecast(provided, shipped("second_chance"), prime_fails(), 2, 2);
    REQUIRE(survived);
    CHECK(landed(survived->with) == 2);
}

TEST_CASE("a command that is assumed acts in each case, on its side only", "[shadow][R58]") {
    const auto scenario = shipped("nominal_auto");
    const auto landing = flown_to(scenario, -1000.0);
    Assumption assumption;
    auto slower = command("EDL_SET_PARAMETERS");
    slower.from_solution = true;
    slower.arguments = {{"parachute_speed_mps", 390.0}};
    assumption.commands = {slower};
    const auto flown = forecast(landing, scenario, assumption, 1, 2);
    INFO((flown ? "" : flown.error().message));
    REQUIRE(flown);
    CHECK(flown->without[0].outcome == "touchdown");
    const auto deployed_mps = [](const campaign::CaseResult& result) {
        return std::ranges::find(result.events, "parachute_deploy", &campaign::CaseEvent::name)->speed_mps;
    };
    CHECK(flown->with[0].outcome == "touchdown");
    CHECK(deployed_mps(flown->without[0]) - deployed_mps(flown->with[0]) == Approx(15.0).margin(5.0));
    // Nothing is left of it in the landing that was asked about.
    const auto again = forecast(landing, scenario, {}, 1, 1);
    REQUIRE(again);
    CHECK(again->without[0].propellant_kg == flown->without[0].propellant_kg);
}

TEST_CASE("the case without anything drawn anew is the landing itself: what is assumed of nothing changes nothing",
          "[shadow][R58]") {
    const auto scenario = shipped("nominal_auto");
    simulation::Landing alone{before_entry().landing()};
    alone.fly_unheard();
    ScriptedLanding heard{before_entry()};
    while (alone.outcome() == simulation::Outcome::running) alone.step();
    while (heard.landing().outcome() == simulation::Outcome::running) heard.hear(heard.step());
    CHECK(alone.touchdown()->miss_m == heard.landing().touchdown()->miss_m);
    CHECK(alone.inspect().propellant_kg == heard.landing().inspect().propellant_kg);
}

TEST_CASE("before a scenario draws its errors a case of a forecast is the campaign's of that number",
          "[shadow][campaign]") {
    const auto scenario = shipped("campaign");
    const campaign::CaseFlights flights{scenario, 1, tests::shipped_dictionary()};
    const auto flown = forecast(flown_to(scenario, -30.0), scenario, {}, 2, 2);
    REQUIRE(flown);
    for (const auto& result : flown->without) {
        const auto of_campaign = flights.fly(result.number);
        REQUIRE(of_campaign);
        CHECK(result.outcome == of_campaign->outcome);
        CHECK(result.touchdown->miss_m == of_campaign->touchdown->miss_m);
        CHECK(result.propellant_kg == of_campaign->propellant_kg);
        CHECK(result.margins.size() == of_campaign->margins.size());
    }
}

TEST_CASE("what cannot be forecast is refused by name", "[shadow][R58]") {
    const auto scenario = shipped("nominal_auto");
    Assumption assumption;
    assumption.commands = {command("EDL_DO_EDL")};
    const auto refused = forecast(before_entry(), scenario, assumption, 1, 1);
    REQUIRE_FALSE(refused);
    CHECK_THAT(refused.error().message, Catch::StartsWith("EDL_DO_EDL is refused: "));
    assumption.commands = {command("EDL_FROB")};
    const auto unknown = forecast(before_entry(), scenario, assumption, 1, 1);
    REQUIRE_FALSE(unknown);
    CHECK_THAT(unknown.error().message, Catch::StartsWith("EDL_FROB is refused: "));
    CHECK(forecast(before_entry(), scenario, {}, 0, 1).error().message == "cases: 0 is not between 1 and 1000");
    ScriptedLanding over{before_entry()};
    while (over.landing().outcome() == simulation::Outcome::running) over.step();
    CHECK(forecast(over, scenario, {}, 1, 1).error().message == "the landing is over: nothing is to come");
}

TEST_CASE("a forecast that is stopped tells nothing, soon; one that goes on tells how far it is", "[shadow][R58]") {
    const auto scenario = shipped("nominal_auto");
    std::atomic<bool> stop{false};
    std::uint64_t told = 0;
    const auto stopped = forecast_from_truth(before_entry(), scenario, tests::shipped_dictionary(), {},
                                             {.cases = 1000, .jobs = 2}, stop, [&](const ForecastProgress& so_far) {
                                                 CHECK(so_far.of == 1000);
                                                 if (++told == 2) stop = true;
                                             });
    REQUIRE_FALSE(stopped);
    CHECK(stopped.error().message == "the forecast was stopped: nothing is told of fewer cases than were asked for");
}

TEST_CASE("a forecast's report says that it is from the truth, and that few cases are too few", "[shadow][R58]") {
    const auto scenario = shipped("nominal_auto");
    const auto flown = forecast(before_entry(), scenario, {}, 2, 2);
    REQUIRE(flown);
    const ForecastCall call{"nominal_auto", 1, {.cases = 2}, {}};
    const std::string table = forecast_table(*flown, scenario.limits, call),
                      json = forecast_json(*flown, scenario.limits, call);
    CHECK_THAT(table, Catch::StartsWith("from the truth of nominal_auto, seed 1, at E-20.0 s: 2 cases"));
    CHECK_THAT(table, Catch::Contains("for a 99 % interval 2 cases are too few"));
    CHECK_THAT(json, Catch::StartsWith("{\"from\":\"truth\""));
    CHECK_THAT(json, Catch::Contains("\"ellipse_99\":null") && Catch::Contains("\"interval_99\":null"));
}

}  // namespace server_shadow_forecast_test
