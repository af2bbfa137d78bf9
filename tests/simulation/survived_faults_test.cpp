// SPDX-License-Identifier: Apache-2.0
#include "generated/dictionary_flight.hpp"
#include "simulation/limits.hpp"
#include "simulation/random.hpp"
#include "tests/simulation/calm.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/simulation/judged.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/recorded_events.hpp"
#include "tests/support/telecommands.hpp"

#include <cmath>
#include <initializer_list>
#include <string>
#include <vector>

namespace simulation_survived_faults_test {

using namespace aeolis;
using namespace aeolis::simulation;

// Faults that GNC survives, each at moments drawn by a seed, in landings forked from one. docs/faults.md
namespace {

void command(Landing& landing) {
    landing.uplink(test::set_parameters(landing.solution()));
    for (int i = 0; i < 64; ++i) landing.step();
    landing.uplink(test::do_edl());
}

Judgement flown_to_its_end(Landing& landing) {
    while (landing.outcome() == Outcome::running) landing.step();
    return tests::judged_held_up(landing);
}

using tests::Calm, tests::Silence;

void check_silences(std::uint64_t seed, int short_ones, int long_ones) {
    Landing common{tests::gale_scenario(900.0), seed};
    command(common);
    while (common.truth().e_s < -530.0) common.step();
    const Calm calm{common};
    Random random{seed, 0, Stream::imu};
    std::vector<Silence> silences;
    const auto moment = [&] { return std::floor(64.0 * (-520.0 + random.uniform() * (calm.end_s() + 490.0))) / 64.0; };
    for (int i = 0; i < short_ones; ++i) silences.push_back({moment(), 0.5});
    for (int i = 0; i < long_ones;) {
        const Silence silence{moment(), 2.0};
        if (!calm.during(silence)) continue;
        silences.push_back(silence);
        ++i;
    }
    std::ranges::sort(silences, {}, &Silence::e_s);
    for (const Silence& silence : silences) {
        INFO("seed " << seed << ", IMU silent for " << silence.length_s << " s from E" << silence.e_s);
        while (common.truth().e_s < silence.e_s && common.outcome() == Outcome::running) common.step();
        Landing landing{common};
        landing.inject(
            DeviceFault{flight::Device::imu, flight::Unit::a, DeviceFault::Kind::silent, 0.0, silence.length_s});
        const Judgement judgement = flown_to_its_end(landing);
        INFO(landing.outcome_reason() << " " << text_of(judgement.exceeded));
        CHECK(judgement.verdict == Verdict::landed);
        CHECK(tests::count_recorded<flight::evr::IMU_SILENT>(landing.recording()) == 1);
        CHECK(tests::count_recorded<flight::evr::IMU_HEARD_AGAIN>(landing.recording()) == 1);
    }
}

/// `short_km` nearer to the target than the delivery was planned for.
Scenario delivered_short(double short_km) {
    constexpr double km_per_degree = 59.18;  // of longitude, at the latitude of entry
    Scenario scenario = tests::gale_scenario(900.0);
    scenario.entry.longitude_deg += short_km / km_per_degree;
    return scenario;
}

void check_short_entry(double short_km, std::uint64_t seed) {
    INFO(short_km << " km short, seed " << seed);
    // What is loaded is made for the entry that was planned, not for this one.
    Landing landing{delivered_short(short_km), seed};
    command(landing);
    std::optional<double> mortar_m;
    while (landing.outcome() == Outcome::running)
        for (const TruthEvent& event : landing.step().events)
            if (event.name == "parachute_deploy") mortar_m = event.altitude_m;
    const Judgement judgement = tests::judged_held_up(landing);
    INFO(reason_of(landing, judgement));
    REQUIRE(landing.parachute());
    INFO("mortar at " << mortar_m.value_or(0.0) << " m, Mach " << landing.parachute()->mach << ", "
                      << landing.parachute()->dynamic_pressure_Pa << " Pa");
    CHECK(mortar_m.value_or(0.0) >= 5500.0);
    CHECK(judgement.verdict == Verdict::landed);
}

/// Engine controllers that say nothing, or take no command, for half a second: from before the backshell's separation
/// to the end of the landing, each `every_s`.
void check_engines(std::uint64_t seed, double every_s, std::initializer_list<DeviceFault::Kind> kinds) {
    constexpr double length_s = 0.5, from_e_s = 375.0;
    Landing common{tests::gale_scenario(900.0), seed};
    command(common);
    int tried = 0;
    for (double e_s = from_e_s; common.outcome() == Outcome::running; e_s += every_s) {
        while (common.truth().e_s < e_s && common.outcome() == Outcome::running) common.step();
        for (const auto kind : kinds) {
            INFO("seed " << seed << ", engines " << static_cast<int>(kind) << " from E+" << e_s);
            Landing landing{common};
            for (const auto unit : {flight::Unit::a, flight::Unit::b})
                landing.inject(DeviceFault{flight::Device::descent_engines, unit, kind, 0.0, length_s});
            const Judgement judgement = flown_to_its_end(landing);
            INFO(reason_of(landing, judgement));
            CHECK(judgement.verdict == Verdict::landed);
            ++tried;
        }
    }
    CHECK(tried > 40.0 / every_s);
}

}  // namespace

TEST_CASE(
    "the IMU is silent for half a second at any time, or for two where attitude can be known, and the rover lands",
    "[simulation][faults][R27]") {
    check_silences(1, 6, 5);
}

TEST_CASE("two hundred silences of the IMU are survived", "[.long][simulation][faults][R27]") {
    for (std::uint64_t seed = 2; seed <= 6; ++seed) check_silences(seed, 20, 20);
}

TEST_CASE("from an entry that is short the parachute opens in time, at a speed and pressure that it bears",
          "[simulation][faults][R27]") {
    for (const double short_km : {20.0, 40.0, 60.0, 80.0}) check_short_entry(short_km, 1);
    check_short_entry(80.0, 2);
}

TEST_CASE("a heatshield whose speed never comes goes all the same, and the radar sees the ground",
          "[simulation][faults][R27]") {
    Scenario scenario = tests::gale_scenario(900.0);
    scenario.heatshield_speed_mps = 40.0;  // nothing under this parachute is so slow
    Landing landing{scenario, 1};
    command(landing);
    const Judgement judgement = flown_to_its_end(landing);
    INFO(landing.outcome_reason());
    CHECK(judgement.verdict == Verdict::landed);
}

TEST_CASE("a radar that is silent for a while, or from the sky crane on, is survived; silent for good before that "
          "it is not, and it is told",
          "[simulation][faults][R27][release]") {
    constexpr double for_good_s = 1000.0;
    struct Tried {
        double from_e_s, length_s;
        bool lands;
    };
    for (const std::uint64_t seed : {1U, 2U}) {
        Landing common{tests::gale_scenario(900.0), seed};
        command(common);
        for (const Tried& tried :
             {Tried{260.0, for_good_s, false}, Tried{300.0, 40.0, true}, Tried{340.0, for_good_s, false},
              Tried{350.0, 20.0, true}, Tried{410.0, for_good_s, true}}) {
            INFO("seed " << seed << ", radar silent for " << tried.length_s << " s from E+" << tried.from_e_s);
            while (common.truth().e_s < tried.from_e_s) common.step();
            Landing landing{common};
            for (const auto unit : {flight::Unit::a, flight::Unit::b})
                landing.inject(
                    DeviceFault{flight::Device::radar, unit, DeviceFault::Kind::silent, 0.0, tried.length_s});
            const Judgement judgement = flown_to_its_end(landing);
            INFO(landing.outcome_reason() << " " << text_of(judgement.exceeded));
            CHECK((judgement.verdict == Verdict::landed) == tried.lands);
            if (!tried.lands) CHECK(tests::count_recorded<flight::evr::RADAR_LOST>(landing.recording()) >= 1);
        }
    }
}

TEST_CASE("engine controllers that are silent, or take no command, for half a second at any time are survived",
          "[simulation][faults][R27][release]") {
    check_engines(1, 2.0, {DeviceFault::Kind::silent});
    check_engines(2, 2.0, {DeviceFault::Kind::refuses});
}

TEST_CASE("engine controllers that are silent, or take no command, for half a second are survived at each eighth of a "
          "second of three landings",
          "[.long][simulation][faults][R27]") {
    for (std::uint64_t seed = 1; seed <= 3; ++seed)
        check_engines(seed, 0.125, {DeviceFault::Kind::silent, DeviceFault::Kind::refuses});
}

TEST_CASE("propellant that runs low is told once, on board", "[simulation][faults][R27]") {
    Scenario scenario = tests::gale_scenario(900.0);
    scenario.masses.propellant_kg -= 60.0;
    scenario.masses.powered_descent_kg -= 60.0;
    scenario.masses.entry_kg -= 60.0;
    Landing landing{scenario, 1};
    command(landing);
    flown_to_its_end(landing);
    CHECK(tests::count_recorded<flight::evr::PROPELLANT_LOW>(landing.recording()) == 1);
}

}  // namespace simulation_survived_faults_test
