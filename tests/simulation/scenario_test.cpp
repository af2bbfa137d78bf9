// SPDX-License-Identifier: Apache-2.0
#include "simulation/scenario.hpp"

#include "tests/simulation/gale.hpp"
#include "tests/support/catch.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace simulation_scenario_test {

using namespace aeolis;
using namespace aeolis::simulation;

namespace {

std::string only_fault(const Scenario& scenario) {
    const auto found = impossible_values(scenario);
    INFO(found.size());
    REQUIRE(found.size() == 1);
    return found.front();
}

}  // namespace

TEST_CASE("the nominal scenario is possible", "[simulation][scenario]") {
    CHECK(impossible_values(tests::gale_scenario()).empty());
}

TEST_CASE("the course at the target leads away from entry", "[simulation][scenario]") {
    auto scenario = tests::gale_scenario();
    scenario.entry.latitude_deg = scenario.target.latitude_deg = 0.0;
    scenario.target.longitude_deg = scenario.entry.longitude_deg + 10.0;
    CHECK(course_at_target_deg(scenario) == Approx(90.0));
    scenario.target.longitude_deg = scenario.entry.longitude_deg - 10.0;
    CHECK(course_at_target_deg(scenario) == Approx(270.0));
    scenario.target = {10.0, scenario.entry.longitude_deg};
    CHECK(std::sin(course_at_target_deg(scenario) * std::numbers::pi / 180.0) == Approx(0.0).margin(1e-9));
    CHECK(std::cos(course_at_target_deg(scenario) * std::numbers::pi / 180.0) == Approx(1.0));
}

TEST_CASE("an impossible value is named, with its bounds", "[simulation][scenario]") {
    Scenario scenario = tests::gale_scenario();
    scenario.entry.speed_mps = -3.0;
    CHECK(only_fault(scenario) == "entry.speed_mps: -3 is outside 1000 … 20000");

    scenario = tests::gale_scenario();
    scenario.radio.light_time_s = std::numeric_limits<double>::quiet_NaN();
    CHECK(only_fault(scenario).find("radio.light_time_s: ") == 0);

    scenario = tests::gale_scenario();
    scenario.start_before_entry_s = 1200.001;
    CHECK(only_fault(scenario) == "start_before_entry_s: 1200.001 is not a multiple of 1/64 s");

    scenario = tests::gale_scenario();
    scenario.masses.entry_kg = 3000.0;
    CHECK(only_fault(scenario) == "masses.entry_kg: 3000 is not the sum of its parts, 3153");

    scenario = tests::gale_scenario();
    scenario.target.ellipse_major_m = 20000.0;  // an ellipse has two axes
    CHECK(only_fault(scenario) == "target.ellipse_minor_m: 0 is outside 1 … 20000");
    scenario.target.ellipse_minor_m = 20001.0;
    CHECK(only_fault(scenario) == "target.ellipse_minor_m: 20001 is outside 1 … 20000");

    scenario = tests::gale_scenario();
    scenario.target.longitude_deg = 128.0;
    CHECK(only_fault(scenario) == "target: out of range: 86 km from entry is outside 300 … 1500 km");

    scenario = tests::gale_scenario();
    scenario.density_scale = {{1000.0, 1.0}, {500.0, 1.0}};
    CHECK(only_fault(scenario) == "density_scale[1].altitude_m: 500 does not lie above the one before");

    scenario = tests::gale_scenario();
    scenario.commands.push_back({5000.0, "NO_OP", {}, false});
    CHECK(only_fault(scenario) == "commands[0].send_before_entry_s: 5000 is not within the run");
}

TEST_CASE("every fault is told, not only the first", "[simulation][scenario]") {
    Scenario scenario;
    scenario.entry.azimuth_deg = 400.0;
    const auto found = impossible_values(scenario);
    CHECK(found.size() == 3);  // azimuth, name, entry_scet
}

TEST_CASE("each list of a scenario has a bound, and one that is too long is told in one line",
          "[simulation][scenario]") {
    const auto too_long = [](const std::string& list, std::size_t most, auto&& fill) {
        INFO(list);
        Scenario scenario = tests::gale_scenario();
        fill(scenario, most);
        for (const auto& line : impossible_values(scenario)) CHECK(line.find("more than the") == std::string::npos);
        scenario = tests::gale_scenario();
        fill(scenario, most + 1);
        CHECK(only_fault(scenario) == list + ": has " + std::to_string(most + 1) + " rows, more than the " +
                                          std::to_string(most) + " that are taken");
    };
    too_long("radio.tracking_passes", scenario_passes_max,
             [](Scenario& s, std::size_t rows) { s.radio.tracking_passes.resize(rows); });
    too_long("radio.relay_passes", scenario_passes_max,
             [](Scenario& s, std::size_t rows) { s.radio.relay_passes.resize(rows); });
    too_long("radio.relay_passes[0].rates", scenario_rows_max, [](Scenario& s, std::size_t rows) {
        s.radio.relay_passes.resize(1);
        s.radio.relay_passes[0].rates.resize(rows);
    });
    too_long("radio.tone_outages", scenario_rows_max,
             [](Scenario& s, std::size_t rows) { s.radio.tone_outages.resize(rows); });
    too_long("radio.delivery_restarts_after_touchdown_s", scenario_rows_max,
             [](Scenario& s, std::size_t rows) { s.radio.delivery_restarts_after_touchdown_s.resize(rows); });
    too_long("density_scale", scenario_rows_max, [](Scenario& s, std::size_t rows) { s.density_scale.resize(rows); });
    too_long("commands", scenario_rows_max, [](Scenario& s, std::size_t rows) { s.commands.resize(rows); });
    too_long("commands[0].arguments", scenario_rows_max, [](Scenario& s, std::size_t rows) {
        s.commands.resize(1);
        s.commands[0].arguments.resize(rows);
    });
    too_long("second_person", scenario_rows_max, [](Scenario& s, std::size_t rows) { s.second_person.resize(rows); });
    too_long("system_faults", scenario_rows_max, [](Scenario& s, std::size_t rows) { s.system_faults.resize(rows); });
    too_long("device_faults", scenario_rows_max, [](Scenario& s, std::size_t rows) { s.device_faults.resize(rows); });
    too_long("orbiter_outages", scenario_rows_max,
             [](Scenario& s, std::size_t rows) { s.orbiter_outages.resize(rows); });
    too_long("uhf_losses", scenario_rows_max, [](Scenario& s, std::size_t rows) { s.uhf_losses.resize(rows); });
    too_long("wind_shifts", scenario_rows_max, [](Scenario& s, std::size_t rows) { s.wind_shifts.resize(rows); });
    too_long("false_tones", scenario_rows_max, [](Scenario& s, std::size_t rows) { s.false_tones.resize(rows); });
    too_long("air_shifts", scenario_rows_max, [](Scenario& s, std::size_t rows) { s.air_shifts.resize(rows); });
    too_long("sensor_errors", scenario_rows_max, [](Scenario& s, std::size_t rows) { s.sensor_errors.resize(rows); });
    too_long("aero_scale", scenario_rows_max, [](Scenario& s, std::size_t rows) { s.aero_scale.resize(rows); });
    too_long("believed.density_scale", scenario_rows_max,
             [](Scenario& s, std::size_t rows) { s.believed.emplace().density_scale.resize(rows); });
    too_long("station_outages", scenario_rows_max,
             [](Scenario& s, std::size_t rows) { s.station_outages.resize(rows); });
    too_long("computer_resets", scenario_rows_max,
             [](Scenario& s, std::size_t rows) { s.computer_resets.resize(rows); });
}

}  // namespace simulation_scenario_test
