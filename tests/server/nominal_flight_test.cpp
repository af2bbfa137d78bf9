// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/nominal_flight.hpp"

#include "server/rehearsal/recorded_firings.hpp"
#include "server/rehearsal/scripted_landing.hpp"
#include "server/scenario/scenario_text.hpp"
#include "tests/server/running_server.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>
#include <cmath>

namespace server_nominal_flight_test {

using namespace aeolis;
using namespace aeolis::server;

namespace {

const simulation::Scenario& flown_scenario() {
    static const auto scenario = expected_scenario(test::shipped_scenario("nominal"));
    return scenario;
}
/// Flown once for all tests of this file.
const NominalFlight& nominal_flight() {
    static const auto flight = fly_nominally(flown_scenario(), tests::shipped_dictionary());
    REQUIRE(flight);
    return *flight;
}

/// Of a timepoint or, if there is none of this name, of an event report.
std::optional<double> e_s_of(const NominalFlight& flight, std::string_view name) {
    std::optional<double> e_s;
    for (const auto& event : flight.events)
        if (event.name == name && (!e_s || event.timepoint)) e_s = event.e_s;
    return e_s;
}

const std::vector<NominalFlight::Sample>& samples_of(const NominalFlight& flight, const char* name) {
    const auto* channel = tests::shipped_dictionary().channel(name);
    REQUIRE(channel != nullptr);
    return flight.samples[channel->id.value];
}

simulation::DeviceFault silent_radar() {
    simulation::DeviceFault fault;
    fault.device = flight::Device::radar;
    fault.unit = flight::Unit::a;
    fault.kind = simulation::DeviceFault::Kind::silent;
    fault.duration_s = 20.0;
    return fault;
}

}  // namespace

TEST_CASE("a nominal flight lands, and has each timepoint and the moments between them in their order",
          "[prediction]") {
    const auto& flight = nominal_flight();
    CHECK(flight.outcome == "touchdown");
    CHECK(std::ranges::is_sorted(flight.events, {}, &NominalFlight::Event::e_s));
    for (const auto& row : tests::shipped_dictionary().timeline) {
        INFO(row.name);
        CHECK(e_s_of(flight, row.name));
    }
    for (const char* moment : {"peak_deceleration", "heading_alignment", "radar_lock"}) {
        INFO(moment);
        CHECK(e_s_of(flight, moment));
    }
    REQUIRE(e_s_of(flight, "entry_interface"));
    CHECK(*e_s_of(flight, "entry_interface") == Approx(0.0).margin(1.0));
    CHECK(*e_s_of(flight, "touchdown") == Approx(431.0).margin(30.0));
}

TEST_CASE("the ellipse is the scenario's own, along its course, and a scenario without one has none", "[prediction]") {
    CHECK_FALSE(ellipse_of(simulation::Scenario{}));
    const auto& flight = nominal_flight();
    REQUIRE(flight.ellipse);
    CHECK(flight.ellipse->major_m == 20'000.0);
    CHECK(flight.ellipse->minor_m == 7'000.0);
    CHECK(flight.ellipse->azimuth_deg == Approx(94.0).margin(2.0));  // [od137]: entry at 93.35°
}

TEST_CASE("predicted channels have a sample a second as telemetry decodes it, and a gap where a value is undefined",
          "[prediction]") {
    const auto& flight = nominal_flight();
    const auto& altitude = samples_of(flight, "altitude_m");
    REQUIRE(altitude.size() > 400);
    for (std::size_t i = 1; i < altitude.size(); ++i)
        CHECK(std::floor(altitude[i].e_s) > std::floor(altitude[i - 1].e_s));
    const auto at = [&](double e_s) {
        return std::ranges::find_if(altitude, [&](const auto& each) { return each.e_s >= e_s; })->value;
    };
    CHECK(at(0.0) == Approx(131'052.0).margin(3'000.0));  // entry interface: 3 522.2 km less the landing radius
    CHECK(at(430.0) < 100.0);
    // Until the radar has a solution its altitude is undefined.
    const auto& radar = samples_of(flight, "radar_altitude_m");
    REQUIRE_FALSE(radar.empty());
    CHECK(radar.front().e_s > *e_s_of(flight, "heatshield_separation"));
    std::size_t octets = 0;
    for (const auto& samples : flight.samples) octets += samples.size() * sizeof(NominalFlight::Sample);
    CHECK(octets < (16U << 20U));  // as docs/architecture.md says
}

TEST_CASE("scenarios that differ in faults, errors, losses and name are expected to go alike", "[prediction]") {
    const auto scenario = test::shipped_scenario("nominal_auto");
    auto other = scenario;
    other.name = "surprise";
    other.title = "Radar A fails";
    other.dispersions.density_fraction = 0.3;
    other.disperse_before_entry_s = 10.0;
    other.device_faults = {silent_radar()};
    other.system_faults = {{300.0, 20.0}};
    other.computer_resets = {{-100.0}};
    other.station_outages = {{200.0, 30.0}};
    other.orbiter_outages = {{200.0, 30.0}};
    other.uhf_losses = {{200.0, 30.0, 0.5}};
    other.wind_shifts = {{200.0, 30.0, 5.0, 5.0}};
    other.air_shifts = {{200.0, 30.0, -0.1}};
    other.false_tones = {{200.0, 30.0, ToneId{1}}};
    other.sensor_errors = {{flight::Device::imu, flight::Unit::a, 200.0, 30.0, 0.1, 0.0}};
    other.bus_message_error_fraction = 0.01;
    other.radio.uhf_loss_fraction = 0.5;
    other.radio.uplink_loss_fraction = 0.5;
    other.radio.delivery_restarts_after_touchdown_s = {60.0};
    other.radio.tones_from_samples = true;
    CHECK(scenario_to_text(expected_scenario(scenario)) == scenario_to_text(expected_scenario(other)));
    // What is believed, ground flies by.
    other.believed = simulation::Belief{
        scenario.masses, scenario.density_scale, scenario.aero_scale, scenario.parachute_drag_area_m2, 3.0, 0.0};
    CHECK(expected_scenario(other).steady_wind_east_mps == 3.0);
    CHECK_FALSE(expected_scenario(other).believed);
    other.believed.reset();
    other.commands.pop_back();
    CHECK(scenario_to_text(expected_scenario(scenario)) != scenario_to_text(expected_scenario(other)));
}

TEST_CASE("a nominal flight fires each timepoint within a tick of the landing that its scenario flies without errors",
          "[.long][prediction]") {
    const auto scenario = test::shipped_scenario("od137");
    const auto& dictionary = tests::shipped_dictionary();
    const auto flight = fly_nominally(expected_scenario(scenario), dictionary);
    REQUIRE(flight);
    ScriptedLanding landing{scenario, 0, 0, dictionary};
    RecordedFirings firings{dictionary};
    while (!landing.landing().flown()) {
        landing.hear(landing.step());
        firings.read(landing.landing().report().recorded);
    }
    REQUIRE(firings.all().size() == dictionary.timeline.size());
    for (const auto& firing : firings.all()) {
        INFO(firing.name);
        REQUIRE(e_s_of(*flight, firing.name));
        CHECK(std::abs(*e_s_of(*flight, firing.name) - (firing.fired_sclk - scenario.entry_sclk.seconds)) <=
              seconds_per_tick);
    }
}

TEST_CASE("a scenario of six hours with refused commands, a hold and a reset is predicted by its plan",
          "[.long][prediction]") {
    const auto flight =
        fly_nominally(expected_scenario(test::shipped_scenario("pre_edl")), tests::shipped_dictionary());
    REQUIRE(flight);
    CHECK(*e_s_of(*flight, "touchdown") == Approx(*e_s_of(nominal_flight(), "touchdown")).margin(1.0));
}

TEST_CASE("where nothing can be predicted the reason is said, and a flight that is stopped is no prediction",
          "[prediction]") {
    const auto& dictionary = tests::shipped_dictionary();
    const auto alone = fly_nominally(expected_scenario(test::shipped_scenario("gnc_alone")), dictionary);
    REQUIRE_FALSE(alone);
    CHECK(alone.error().message == "the test venue gnc_alone has no telemetry to predict");
    CHECK_FALSE(alone.error().internal);
    const auto stopped = fly_nominally(flown_scenario(), dictionary, [] { return true; });
    REQUIRE_FALSE(stopped);
    CHECK(stopped.error().internal);
}

TEST_CASE("predicted silences and passes are windows by their beginning; between passes no orbiter is in view",
          "[prediction][silence]") {
    telemetry::PredictedSilences silences;
    silences.uhf_start_s = -800.0;
    silences.x_band_tones_s = -750.0;
    silences.blackout = {45.0, 98.0};
    silences.hand_over_s = 256.0;
    silences.uhf_stop_s = 900.0;
    silences.earth_set_s = 298.0;
    silences.passes = {{"odyssey", -1200.0, 640.0, 0.0, false}, {"mro", -300.0, 720.0, 2520.0, true}};
    const auto windows = windows_of(silences, -1200.0, 0.25);
    std::vector<std::string> told;
    for (const auto& window : windows)
        told.push_back(fmt::format("{} {} {}: {} to {}", window.pass ? "pass" : "silence", window.link, window.words,
                                   window.from_s, window.to_s ? fmt::format("{}", *window.to_s) : "the end"));
    CHECK(told == std::vector<std::string>{
                      "silence uhf_live not begun: -1200 to -800",
                      "silence x_band not begun: -1200 to -750",
                      "pass uhf_live odyssey: -1200 to 640",
                      "silence x_band_telemetry switched off: -750 to the end",
                      "pass uhf_mro mro: -300 to 720",
                      "silence uhf_live plasma blackout: 45 to 98",
                      "silence uhf_live antenna hand-over: 256 to 256.25",
                      "silence x_band Earth set: 298 to the end",
                      "silence uhf_live no orbiter in view: 640 to the end",
                      "silence uhf_live switched off: 900 to the end",
                  });
    CHECK(windows_of({}, -1200.0, 0.0).empty());
}

}  // namespace server_nominal_flight_test
