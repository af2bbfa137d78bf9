// SPDX-License-Identifier: Apache-2.0
#include "server/shadow/ground_flight.hpp"

#include "server/scenario/scenario_text.hpp"
#include "server/shadow/forecast.hpp"
#include "server/shadow/forecast_report.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <array>
#include <cmath>

namespace server_ground_flight_test {

using namespace aeolis;
using namespace aeolis::server;
using namespace aeolis::server::shadow;

namespace {

const std::atomic<bool> never{false};

simulation::Scenario shipped(const char* name) {
    auto scenario = scenario_from_file(std::string{AEOLIS_SOURCE_DIR "/simulation/scenarios/"} + name + ".textproto");
    REQUIRE(scenario);
    return *scenario;
}

/// A landing at some instant, and what ground had heard of it by then.
struct Followed {
    ScriptedLanding landing;
    HeardFlight heard{tests::shipped_dictionary()};
    std::uint64_t cycles = 0;

    Followed(const simulation::Scenario& scenario, std::uint64_t seed)
        : landing(scenario, seed, 0, tests::shipped_dictionary()) {}
    void fly_to(const simulation::Scenario& scenario, double e_s) {
        while (landing.landing().sclk() < scenario.entry_sclk + e_s) {
            auto& received = landing.step();
            landing.hear(received);
            landing.take_stages();
            heard.hear(received);
            ++cycles;
        }
    }
    Result<GroundFlight> by_ground(const simulation::Scenario& scenario) const {
        archive::FlownRun run;
        run.clock = landing.landing().correlation();
        return fly_by_ground(scenario, landing.landing().solution(), run, heard, {cycles, true},
                             tests::shipped_dictionary(), [] { return false; });
    }
};

double apart_m(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

}  // namespace

TEST_CASE("the ground's flight is where the vehicle believes to be, and as far from the truth as that",
          "[shadow][R57]") {
    const auto scenario = shipped("nominal_auto");
    Followed followed{scenario, 7};
    for (const double e_s : {-100.0, 40.0, 200.0, 330.0}) {
        followed.fly_to(scenario, e_s);
        const auto ground = followed.by_ground(scenario);
        INFO("at E" << e_s << " s: " << (ground ? "" : ground.error().message));
        REQUIRE(ground);
        REQUIRE(ground->heard);
        CHECK(followed.landing.landing().sclk() - *ground->heard < 2.0);
        const auto& own = ground->rehearsal->landing();
        CHECK(own.sclk() == followed.landing.landing().sclk());
        const NavigatedState belief = followed.heard.states().back();
        CHECK(belief.sclk == *ground->heard);
        std::array<double, 3> coasted = belief.p_MoB_M_m;
        for (std::size_t axis = 0; axis < 3; ++axis)
            coasted[axis] += belief.v_MB_M_mps[axis] * (own.sclk() - belief.sclk);
        CHECK(apart_m(own.truth().p_MoB_M_m, coasted) < 250.0);  // two seconds of ten g
        const double wrong_m = apart_m(coasted, followed.landing.landing().truth().p_MoB_M_m);
        CHECK(wrong_m > 300.0);
        CHECK(std::abs(apart_m(own.truth().p_MoB_M_m, followed.landing.landing().truth().p_MoB_M_m) - wrong_m) < 250.0);
    }
}

TEST_CASE("a fault that has not shown itself changes nothing of the ground's flight, bit for bit", "[shadow][R57]") {
    const auto scenario = shipped("nominal_auto");
    auto hidden = scenario;
    hidden.device_faults.push_back({});
    hidden.device_faults.back().begin_before_entry_s = -300.0;  // at E+300 s
    hidden.device_faults.back().duration_s = 10.0;
    Followed open{scenario, 3}, plan{hidden, 3};
    for (Followed* const each : {&open, &plan}) each->fly_to(scenario, 30.0);
    const auto by_open = open.by_ground(scenario), by_plan = plan.by_ground(hidden);
    REQUIRE(by_open);
    REQUIRE(by_plan);
    CHECK(by_open->rehearsal->landing().truth().p_MoB_M_m == by_plan->rehearsal->landing().truth().p_MoB_M_m);
    CHECK(by_open->rehearsal->digest() == by_plan->rehearsal->digest());
}

TEST_CASE("what the vehicle tells and ground does not expect is named, and nothing is forecast from then on",
          "[shadow][R57][R58]") {
    const auto scenario = shipped("second_chance");
    Followed followed{scenario, 3};
    followed.fly_to(scenario, 90.0);
    CHECK(followed.by_ground(scenario));
    followed.fly_to(scenario, 150.0);
    const auto after = followed.by_ground(scenario);
    REQUIRE_FALSE(after);
    CHECK_THAT(after.error().message,
               Catch::Contains("s the vehicle told SECOND_CHANCE_TAKES_OVER, which nothing made"));
}

TEST_CASE("a timeline that does not run, or stands elsewhere, is a departure before anything is navigated",
          "[shadow][R57][R58]") {
    const auto begun = shipped("nominal_auto"), waits = shipped("nominal");
    Followed followed{waits, 3};
    followed.fly_to(waits, -650.0);
    CHECK(followed.by_ground(waits));
    const auto expected_to_run = followed.by_ground(begun);
    REQUIRE_FALSE(expected_to_run);
    CHECK_THAT(expected_to_run.error().message,
               Catch::Contains("the vehicle's timeline stood at ") && Catch::Contains("ask again"));
}

TEST_CASE("packets that a lossy link lost, and three orbiters, leave ground's flight the vehicle's", "[shadow][R58]") {
    const auto scenario = shipped("relay_passes");
    Followed followed{scenario, 2};
    for (const double e_s : {-200.0, 150.0, 300.0}) {
        followed.fly_to(scenario, e_s);
        const auto ground = followed.by_ground(scenario);
        INFO("at E" << e_s << " s: " << (ground ? "" : ground.error().message));
        CHECK(ground);
    }
}

TEST_CASE("cases by telemetry touch down, and say how well the state is known that they are from", "[shadow][R58]") {
    const auto scenario = shipped("nominal_auto");
    Followed followed{scenario, 7};
    followed.fly_to(scenario, 330.0);
    const auto ground = followed.by_ground(scenario);
    REQUIRE(ground);
    CHECK(ground->knowledge.height_m == 5.0);
    CHECK(ground->knowledge.position_m == scenario.dispersions.knowledge_position_m);
    const auto forecast = forecast_by_ground(*ground, scenario, tests::shipped_dictionary(), {},
                                             {.seed = 1, .cases = 4, .jobs = 2}, never);
    REQUIRE(forecast);
    for (const auto& each : forecast->without) CHECK(each.outcome == "touchdown");
    const auto said = forecast_json(*forecast, scenario.limits, {});
    CHECK(said.find("\"from\":\"telemetry\"") != std::string::npos);
    CHECK(said.find("\"heard_e_s\":") != std::string::npos);
    CHECK(said.find("\"height_m\":5") != std::string::npos);
}

}  // namespace server_ground_flight_test
