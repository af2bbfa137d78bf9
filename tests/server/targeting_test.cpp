// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/targeting.hpp"

#include "simulation/devices/load.hpp"
#include "simulation/initial_state.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/gnc_venue.hpp"
#include "tests/support/temporary_folder.hpp"

#include <cmath>
#include <fstream>
#include <vector>

namespace server_targeting_test {

using namespace aeolis;
using namespace aeolis::server;
using namespace aeolis::server::campaign;

namespace {

/// Four cases about a mean; what did not land has no place.
CaseTable landings(double east_m, double north_m, std::size_t lost = 0) {
    CaseTable table;
    std::vector<double> easts, norths;
    for (std::size_t i = 0; i < 4 + lost; ++i) {
        table.numbers.push_back(i + 1);
        table.outcomes.emplace_back(i < 4 ? "touchdown" : "lost");
        const double off_m = i % 2 == 0 ? 300.0 : -300.0;
        easts.push_back(i < 4 ? east_m + off_m : std::nan(""));
        norths.push_back(i < 4 ? north_m - 2.0 * off_m : std::nan(""));
    }
    table.columns = {{"east_m", easts}, {"north_m", norths}};
    return table;
}

}  // namespace

TEST_CASE("the aim is moved against the mean miss until the mean meets the target", "[campaign][targeting]") {
    std::vector<Aim> asked;
    const auto targeting = aim_at_target({}, 50.0, 5, [&](const Aim& aim) -> Result<CaseTable> {
        asked.push_back(aim);
        return landings(-1300.0 + 0.9 * aim.east_m, 520.0 + 1.1 * aim.north_m, 1);
    });
    REQUIRE(targeting.ok());
    CHECK(targeting->reached);
    REQUIRE(targeting->rounds.size() == 3);
    CHECK(asked[0] == Aim{});
    CHECK(asked[1] == Aim{1300.0, -520.0});
    CHECK(asked[2] == Aim{1430.0, -468.0});
    CHECK(targeting->rounds[0].landed == 4);
    CHECK(targeting->rounds[0].cases == 5);
    CHECK(targeting->rounds[0].miss_m() == Approx(std::hypot(1300.0, 520.0)));
    CHECK(targeting->rounds[0].east_sigma_m == Approx(300.0 * std::sqrt(4.0 / 3.0) / 2.0));
    CHECK(targeting->rounds.back().miss_m() < 50.0);
    const auto table = targeting_table(*targeting);
    CHECK_THAT(table, Catch::Contains("1430, -468") && Catch::Contains("4/5") && Catch::Contains("-1300 ± 173"));
}

TEST_CASE("an aim that does not help ends after its rounds, and says that it did not", "[campaign][targeting]") {
    const auto stuck = aim_at_target({}, 50.0, 3, [](const Aim&) -> Result<CaseTable> { return landings(400.0, 0.0); });
    REQUIRE(stuck.ok());
    CHECK_FALSE(stuck->reached);
    CHECK(stuck->rounds.size() == 3);

    const auto far = aim_at_target({}, 50.0, 3, [](const Aim&) -> Result<CaseTable> { return landings(31000.0, 0.0); });
    REQUIRE_FALSE(far.ok());
    CHECK_THAT(far.error().message, Catch::Contains("is the target within the vehicle's reach?"));

    const auto none = aim_at_target({}, 50.0, 3, [](const Aim&) -> Result<CaseTable> { return CaseTable{}; });
    REQUIRE_FALSE(none.ok());
    CHECK_THAT(none.error().message, Catch::Contains("0 of 0 cases landed by an aim of 0 m east and 0 m north"));
}

TEST_CASE("guidance has the aim on board, and ground sends the target", "[campaign][targeting]") {
    const auto scenario = tests::undisturbed_scenario();
    CHECK(aim_of(scenario) == Aim{});
    const auto aimed = with_aim(scenario, {1000.0, -2000.0});
    CHECK(aim_of(aimed) == Aim{1000.0, -2000.0});
    CHECK(aimed.name == "gale-aim-1000e--2000n");
    CHECK(simulation::aimed_target(scenario).latitude_deg == scenario.target.latitude_deg);
    CHECK(simulation::initial_state(aimed, 1, 0).solution.target.latitude_deg == scenario.target.latitude_deg);
    CHECK(simulation::load_for(aimed).aim_north_m == -2000.0);
    const auto told = simulation::aimed_target(aimed);
    const double radius_m = scenario.target.radius_m;
    CHECK((told.latitude_deg - scenario.target.latitude_deg) * simulation::degree_rad * radius_m ==
          Approx(-2000.0).margin(2.0));
    CHECK((told.longitude_deg - scenario.target.longitude_deg) * simulation::degree_rad * radius_m *
              std::cos(scenario.target.latitude_deg * simulation::degree_rad) ==
          Approx(1000.0).margin(2.0));
    CHECK(aimed.target.latitude_deg == scenario.target.latitude_deg);
}

TEST_CASE("a vehicle that aims elsewhere lands as much elsewhere", "[campaign][targeting]") {
    const auto landed_M = [](const simulation::Scenario& scenario) {
        tests::GncVenue venue(scenario, 1);
        venue.run();
        REQUIRE(venue.world().outcome() == simulation::Outcome::touchdown);
        return simulation::vector3(venue.world().truth().p_MoB_M_m);
    };
    const auto scenario = tests::undisturbed_scenario();
    const auto at = landed_M(scenario), elsewhere = landed_M(with_aim(scenario, {1500.0, -800.0}));
    const auto local = simulation::horizon(at);
    CHECK((elsewhere - at).dot(local.east) == Approx(1500.0).margin(400.0));
    CHECK((elsewhere - at).dot(local.north) == Approx(-800.0).margin(400.0));
}

TEST_CASE("aeolis entry target prints the rounds and the line for the scenario", "[campaign][targeting]") {
    if (test::program().empty()) return;
    const test::TemporaryFolder folder;
    std::ofstream{folder / "windy.textproto"} << "name: \"windy\" like: \"gnc_alone\" disperse_before_entry_s: 10 "
                                                 "steady_wind_north_mps: 15\n";
    const auto entry_target = [&](const std::string& more) {
        return test::run(test::program(), "entry target --scenario windy.textproto --cases 3 --folder out " + more,
                         folder.path());
    };
    const auto ran = entry_target("--tolerance-m 300");
    INFO(ran.text);
    CHECK(ran.code == 0);
    CHECK_THAT(ran.text, Catch::Contains("In the scenario (the mean of these 3 landings") &&
                             Catch::Contains("guidance { aim_east_m: "));
    // What was flown is kept, and with one try the target is not met.
    const auto once = entry_target("--tolerance-m 1 --rounds 1");
    CHECK(once.code == 1);
    CHECK_THAT(once.text, Catch::Contains("after 1 round the mean still misses by"));
    CHECK(entry_target("--rounds 0").code == 2);
}

}  // namespace server_targeting_test
