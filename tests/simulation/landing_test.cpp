// SPDX-License-Identifier: Apache-2.0
#include "simulation/landing.hpp"

#include "generated/dictionary_flight.hpp"
#include "simulation/devices/recorder.hpp"
#include "simulation/limits.hpp"
#include "telemetry/proximity_packets.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/simulation/judged.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/gnc_venue.hpp"
#include "tests/support/recorded_events.hpp"
#include "tests/support/telecommands.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

namespace simulation_landing_test {

using namespace aeolis;
using namespace aeolis::simulation;
using aeolis::test::do_edl;
using aeolis::test::set_parameters;

namespace {

std::vector<EventReportName> event_reports() {
    using namespace aeolis::flight;
    const auto named = [](Apid apid, EvrId id, const char* name) { return EventReportName{apid, id, name}; };
    return {named(evr::GUIDANCE_START::apid, evr::GUIDANCE_START::id, "guidance_start"),
            named(evr::HEADING_ALIGNMENT::apid, evr::HEADING_ALIGNMENT::id, "heading_alignment"),
            named(evr::RADAR_LOCK::apid, evr::RADAR_LOCK::id, "radar_lock"),
            named(evr::TOUCHDOWN::apid, evr::TOUCHDOWN::id, "touchdown")};
}

/// What came of a landing that was commanded `ticks` after its start.
struct Flown {
    telemetry::PltuReceiver pltus;
    telemetry::ProximityPackets packets;
    std::size_t relayed_octets = 0;
    std::vector<std::vector<std::uint8_t>> live;
    std::set<std::string> events;
    std::int64_t first_link_us = 0;

    void step(Landing& landing) {
        const CycleReport& report = landing.step();
        for (const telemetry::ReceivedOctets& piece : report.earth.octets) {
            CHECK_FALSE(piece.ert > landing.ert_now());
            if (piece.link.recorded) relayed_octets += piece.octets.size();
            if (piece.link.recorded) continue;
            pltus.receive(piece.octets);
            while (const auto frame = pltus.next()) {
                packets.add(*frame);
                while (const auto packet = packets.next()) live.emplace_back(packet->begin(), packet->end());
            }
        }
        for (const TruthEvent& event : report.events) events.insert(event.name);
        for (const telemetry::LinkState& link : report.earth.links)
            if (first_link_us == 0) first_link_us = link.ert.microseconds;
    }
};

void command(Landing& landing, Flown& flown) {
    landing.uplink(set_parameters(landing.solution()));
    for (int i = 0; i < 640; ++i) flown.step(landing);
    landing.uplink(do_edl());
}

/// What ground's navigators have by tracking now: the truth, within 100 m and 0.03 m/s on each axis.
NavigationSolution tracked(const Landing& landing, std::uint16_t solution_id) {
    constexpr double position_error_m = 100.0, velocity_error_mps = 0.03;
    NavigationSolution solution = landing.solution();
    const TruthState truth = landing.truth();
    solution.solution_id = solution_id;
    solution.epoch = truth.sclk;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double sign = axis % 2 == 0 ? 1.0 : -1.0;
        solution.p_MoB_M_m[axis] = truth.p_MoB_M_m[axis] + sign * position_error_m;
        solution.v_MB_M_mps[axis] = truth.v_MB_M_mps[axis] - sign * velocity_error_mps;
    }
    return solution;
}

std::set<std::vector<std::uint8_t>> packets_of(std::span<const std::uint8_t> recording) {
    std::set<std::vector<std::uint8_t>> packets;
    for (auto packet = take_packet(recording); !packet.empty(); packet = take_packet(recording))
        packets.emplace(packet.begin(), packet.end());
    return packets;
}

}  // namespace

TEST_CASE("a commanded landing stands, and all that was sent live is in its recording", "[simulation][landing][R29]") {
    Landing landing{tests::gale_scenario(1200.0), 1, 0, event_reports()};
    Flown flown;
    command(landing, flown);
    while (!landing.flown()) flown.step(landing);
    INFO(landing.outcome_reason());
    REQUIRE(landing.outcome() == Outcome::touchdown);
    for (const char* name : {"guidance_start", "heading_alignment", "radar_lock", "touchdown"})
        CHECK(flown.events.count(name) == 1);
    CHECK_FALSE(landing.finished());  // nobody has told the rover that its files are down
    CHECK(landing.relaying());
    const auto recorded = packets_of(landing.recording());
    CHECK(flown.live.size() > 1000);
    CHECK(std::ranges::all_of(flown.live, [&](const auto& packet) { return recorded.contains(packet); }));
}

TEST_CASE(
    "do edl six days ahead, and parameters anew a day and two hours before entry: heaters at E-3 h, the phases of "
    "the mission at their times, and a landing within the limits",
    "[.long][simulation][landing][R23][R25][R28]") {
    using namespace aeolis::flight;
    constexpr double six_days_s = 6.0 * 86400.0;
    const Scenario scenario = tests::gale_scenario(six_days_s);
    Landing landing{scenario, 1};
    landing.uplink(set_parameters(landing.solution()));
    for (int i = 0; i < 640; ++i) landing.step();
    landing.uplink(do_edl());
    // The first solution's velocity errs by some m/s for six days: nothing would land by it.
    std::uint16_t solution_id = landing.solution().solution_id;
    for (const double before_entry_s : {86400.0, 7200.0}) {
        while (landing.truth().e_s < -before_entry_s) landing.step();
        landing.uplink(set_parameters(tracked(landing, ++solution_id)));
    }
    while (!landing.flown()) landing.step();
    const Judgement judgement = tests::judged(landing, scenario.limits);
    INFO(reason_of(landing, judgement));
    CHECK(judgement.verdict == Verdict::landed);
    CHECK(tests::count_recorded<evr::EDL_PARAMETERS_ACCEPTED>(landing.recording()) == 3);
    CHECK(tests::count_recorded<evr::SUB_CONSTRAINT_VIOLATED>(landing.recording()) == 0);
    const auto e_s = [&](Sclk at) { return at - scenario.entry_sclk; };
    const auto heaters = tests::recorded<evr::EDL_HEATERS_ON>(landing.recording());
    REQUIRE(heaters.size() == 1);
    CHECK(e_s(heaters[0].at) == Approx(-10'800.0).margin(1.0));
    std::map<EdlPhase, double> began_e_s;
    for (const auto& change : tests::recorded<evr::EDL_PHASE_CHANGED>(landing.recording()))
        began_e_s.emplace(static_cast<EdlPhase>(change.octet), e_s(change.at));
    CHECK(began_e_s.at(EdlPhase::edl_approach) == Approx(-six_days_s + 10.0).margin(5.0));
    CHECK(began_e_s.at(EdlPhase::edl_main) == Approx(-14'400.0).margin(1.0));
    CHECK(began_e_s.at(EdlPhase::exo_atmospheric) == Approx(-600.0).margin(1.0));
    CHECK(began_e_s.at(EdlPhase::landed) > 400.0);
}

TEST_CASE("a copied landing stepped alike stays bit-identical", "[simulation][landing][invariant2]") {
    Landing original{tests::gale_scenario(900.0), 3};
    Flown flown;
    command(original, flown);
    for (int i = 0; i < 64 * 200; ++i) flown.step(original);
    Landing copy{original};
    for (int i = 0; i < 64 * 600; ++i) {
        original.step();
        copy.step();
    }
    CHECK(std::ranges::equal(copy.recording(), original.recording()));
    CHECK(copy.truth().p_MoB_M_m == original.truth().p_MoB_M_m);
    CHECK(original.truth().e_s < 0.0);  // flown on, not stuck at the end
}

TEST_CASE("commands and data each take a light time", "[simulation][landing]") {
    Scenario scenario = tests::gale_scenario(1200.0);
    scenario.radio.light_time_s = 30.0;
    Landing landing{scenario, 1};
    const std::int64_t start_us = landing.ert_now().microseconds;
    const std::size_t before = landing.recording().size();
    Flown flown;
    landing.uplink(do_edl());  // refused, since no parameters came: the refusal is recorded
    const auto records_of_a_second = [&] {
        const std::size_t size = landing.recording().size();
        for (int i = 0; i < 64; ++i) flown.step(landing);
        return landing.recording().size() - size;
    };
    const std::size_t quiet = (records_of_a_second(), records_of_a_second());
    for (int i = 2; i < 29; ++i) records_of_a_second();
    CHECK(flown.first_link_us == 0);  // Earth has heard nothing yet
    const std::size_t arrival = records_of_a_second() + records_of_a_second();
    CHECK(arrival > 2 * quiet);
    CHECK(flown.first_link_us == start_us + 30'000'000);
    CHECK(before == 0);
}

TEST_CASE("a landing that nobody commands ends as not commanded and brings no recording down",
          "[simulation][landing]") {
    Landing landing{tests::gale_scenario(60.0), 1};
    Flown flown;
    while (!landing.finished()) flown.step(landing);
    CHECK(landing.outcome() == Outcome::not_commanded);
    CHECK(flown.relayed_octets == 0);
    CHECK_FALSE(landing.relaying());
}

TEST_CASE("when the computers go off Earth hears that their links are down, not why, a light time later",
          "[simulation][links]") {
    auto scenario = tests::gale_scenario(60.0);
    scenario.timeout_after_entry_s = 60.0;  // nobody commands it
    scenario.radio.light_time_s = 5.0;
    Landing landing{scenario, 1};
    std::map<std::string, LinkTruth> last;
    std::map<std::string, telemetry::LinkState> told;
    std::optional<Ert> off;
    while (!landing.finished()) {
        const CycleReport& report = landing.step();
        for (const LinkTruth& link : report.links) last[link.link.name] = link;
        for (const telemetry::LinkState& link : report.earth.links) told[link.link.name] = link;
        if (landing.flown() && !off) off = landing.ert_now();
    }
    REQUIRE(off);
    for (const char* name : {"uhf_live", "x_band"}) {
        INFO(name);
        REQUIRE(last.contains(name));
        CHECK_FALSE(last.at(name).up);
        if (last.at(name).reason == "computer off")
            CHECK(last.at(name).ert.microseconds - off->microseconds == Approx(5.0e6).margin(2.0e5));
    }
    CHECK(last.at("x_band").reason == "computer off");
    CHECK_FALSE(told.at("uhf_live").up);
    CHECK(told.at("uhf_live").reason().empty());  // ground finds its own
    CHECK_FALSE(told.contains("x_band"));         // a receiver finds the carrier or does not, and none listens
}

namespace {

std::size_t uhf_octets(const CycleReport& report) {
    std::size_t octets = 0;
    for (const auto& received : report.earth.octets)
        if (received.link == telemetry::uhf_live_link) octets += received.octets.size();
    return octets;
}

}  // namespace

TEST_CASE("while the orbiters are out UHF brings nothing, and while it loses octets they come garbled",
          "[simulation][links][faults]") {
    auto scenario = tests::gale_scenario(60.0);
    scenario.timeout_after_entry_s = 60.0;  // nobody commands it: UHF from the start
    Landing whole{scenario, 1}, cut{scenario, 1};
    std::size_t lost = 0, garbled = 0, others_garbled = 0;
    while (cut.sclk() < scenario.entry_sclk) {
        const double e_s = cut.sclk() - scenario.entry_sclk;
        if (e_s == -50.0) cut.inject(OrbiterOutage{0.0, 10.0});
        if (e_s == -30.0) cut.inject(UhfLoss{0.0, 10.0, 0.5});
        const CycleReport& seen = whole.step();
        const CycleReport& report = cut.step();
        CHECK(std::ranges::equal(report.recorded, seen.recorded));  // the vehicle knows nothing of either
        const bool orbiters_out = e_s >= -50.0 && e_s < -40.0, worse = e_s >= -30.0 && e_s < -20.0;
        if (orbiters_out) CHECK(uhf_octets(report) == 0);
        if (orbiters_out) lost += uhf_octets(seen);
        if (!orbiters_out) CHECK(uhf_octets(report) == uhf_octets(seen));
        const bool same = std::ranges::equal(report.earth.octets, seen.earth.octets, {},
                                             &telemetry::ReceivedOctets::octets, &telemetry::ReceivedOctets::octets);
        if (!orbiters_out && !same) ++(worse ? garbled : others_garbled);
    }
    CHECK(lost > 1'000);
    CHECK(garbled > 10);
    CHECK(others_garbled <= 3);  // the last burst may outlast its cause
}

TEST_CASE("a wind that shifts carries the vehicle along, from then on and for as long", "[simulation][faults]") {
    auto scenario = tests::gale_scenario(60.0);
    scenario.test_venue = TestVenue::gnc_alone;  // it enters without commands
    Landing calm{scenario, 1}, windy{scenario, 1};
    const auto apart_m = [&] {
        const auto a = calm.truth().p_MoB_M_m, b = windy.truth().p_MoB_M_m;
        return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
    };
    const auto speed_apart_mps = [&] {
        const auto a = calm.truth().v_MB_M_mps, b = windy.truth().v_MB_M_mps;
        return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
    };
    const auto fly_to = [&](double e_s) {
        while (calm.sclk() < scenario.entry_sclk + e_s) calm.step(), windy.step();
    };
    fly_to(80.0);
    CHECK(apart_m() == 0.0);
    windy.inject(WindShift{0.0, 10.0, 0.0, 50.0});
    fly_to(90.0);
    CHECK(speed_apart_mps() > 0.05);
    CHECK(speed_apart_mps() < 50.0);
    CHECK(apart_m() > 0.1);
    Landing flown_again{scenario, 1};
    while (flown_again.sclk() < scenario.entry_sclk + 80.0) flown_again.step();
    flown_again.inject(WindShift{0.0, 10.0, 0.0, 50.0});
    while (flown_again.sclk() < scenario.entry_sclk + 90.0) flown_again.step();
    CHECK(flown_again.truth().p_MoB_M_m == windy.truth().p_MoB_M_m);
}

TEST_CASE("air that is injected brakes otherwise while it lasts", "[simulation][faults]") {
    auto scenario = tests::gale_scenario(60.0);
    scenario.test_venue = TestVenue::gnc_alone;  // it enters without commands
    Landing calm{scenario, 1}, thin{scenario, 1};
    const auto speed_mps = [](const Landing& landing) {
        const auto v = landing.truth().v_MB_M_mps;
        return std::hypot(v[0], v[1], v[2]);
    };
    const auto fly_to = [&](double e_s) {
        while (calm.sclk() < scenario.entry_sclk + e_s) calm.step(), thin.step();
    };
    fly_to(70.0);
    const double before_mps = speed_mps(calm);
    CHECK(speed_mps(thin) == before_mps);
    thin.inject(AirShift{0.0, 5.0, -0.2});
    fly_to(75.0);
    const double lost_mps = before_mps - speed_mps(calm), lost_in_thin_mps = before_mps - speed_mps(thin);
    CHECK(lost_in_thin_mps == Approx(0.8 * lost_mps).epsilon(0.03));
    fly_to(76.0);  // it is over: as dense again
    CHECK(speed_mps(thin) < before_mps - lost_in_thin_mps);
}

TEST_CASE("an inertial unit that is off moves what is navigated, by the square of the time, and the truth not at all",
          "[simulation][faults]") {
    const auto scenario = tests::undisturbed_scenario(700.0);
    tests::GncVenue sound(scenario, 1);
    auto off = scenario;
    off.sensor_errors = {{flight::Device::imu, flight::Unit::a, -10.0, 20.0, 0.05, 0.0},
                         {flight::Device::imu, flight::Unit::b, -10.0, 20.0, 9.0, 0.0}};
    tests::GncVenue wrong(off, 1);
    const auto apart_m = [&] {
        const auto a = sound.told().p_MoB_M_m, b = wrong.told().p_MoB_M_m;
        return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
    };
    const auto fly_to = [&](double e_s) {
        while (sound.world().truth().e_s < e_s) sound.step(), wrong.step();
    };
    fly_to(9.0);
    CHECK(apart_m() == 0.0);
    CHECK(sound.world().truth().p_MoB_M_m == wrong.world().truth().p_MoB_M_m);
    fly_to(30.0);
    // Each axis is off by as much: √3 of it, while the unit hardly turns.
    const double expected_m = 0.5 * std::sqrt(3.0) * 0.05 * 20.0 * 20.0;
    CHECK(apart_m() > 0.5 * expected_m);
    CHECK(apart_m() < 1.5 * expected_m);
}

TEST_CASE("a radar whose velocities are off or drift leads the vehicle with it", "[simulation][faults]") {
    const auto touchdown_mps = [](double off_by, double grows_per_s) {
        auto scenario = tests::undisturbed_scenario();
        if (off_by != 0.0 || grows_per_s != 0.0)
            scenario.sensor_errors = {{flight::Device::radar, flight::Unit::a, -250.0, 300.0, off_by, grows_per_s}};
        tests::GncVenue venue(scenario, 1);
        venue.run();
        REQUIRE(venue.world().touchdown());
        return venue.world().touchdown()->vertical_mps;
    };
    const double sound_mps = touchdown_mps(0.0, 0.0);
    CHECK(touchdown_mps(0.1, 0.0) == Approx(sound_mps + 0.1).margin(0.05));
    CHECK(touchdown_mps(0.0, 0.001) > sound_mps + 0.05);
}

TEST_CASE("a false tone is sent in place of the vehicle's own while it lasts, and the vehicle knows nothing of it",
          "[simulation][links][faults]") {
    Landing sound{tests::gale_scenario(900.0), 1};
    sound.uplink(test::set_parameters(sound.solution()));
    for (int i = 0; i < 64; ++i) sound.step();
    sound.uplink(test::do_edl());
    while (sound.truth().e_s < -620.0) sound.step();  // X-band sends tones
    Landing told{sound};
    const auto from = told.sclk();
    told.inject(FalseTone{0.0, 20.0, ToneId{200}});
    double false_s = 0.0;
    while (told.sclk() < from + 60.0) {
        for (const SentSymbol& symbol : sound.step().symbols) CHECK(symbol.tone != ToneId{200});
        const CycleReport& report = told.step();
        for (const SentSymbol& symbol : report.symbols) {
            if (symbol.tone != ToneId{200}) continue;
            CHECK(symbol.at >= from);
            CHECK(symbol.at < from + 20.0);
            false_s += static_cast<double>(symbol.end.microseconds - symbol.start.microseconds) / 1e6;
        }
    }
    INFO(false_s << " s of it");
    CHECK(false_s > 5.0);
    CHECK(false_s < 20.1);
    CHECK(std::ranges::equal(told.recording(), sound.recording()));
}

TEST_CASE("while the station is out nothing of what reaches Earth reaches ground; then each link is told as it is",
          "[simulation][links][faults]") {
    auto scenario = tests::gale_scenario(60.0);
    scenario.timeout_after_entry_s = 60.0;  // nobody commands it: X-band's carrier alone, and UHF from the start
    scenario.radio.light_time_s = 5.0;
    Landing whole{scenario, 1}, cut{scenario, 1};
    std::size_t octets = 0, octets_whole = 0;
    std::vector<LinkTruth> told;
    while (!cut.finished()) {
        const CycleReport& seen = whole.step();
        const bool begins = cut.sclk() == scenario.entry_sclk - 30.0;
        if (begins) cut.inject(StationOutage{0.0, 10.0});
        const CycleReport& report = cut.step();
        const double e_s = cut.sclk() - scenario.entry_sclk;  // Earth's clock at the cycle's end
        CHECK(report.earth.station_out == (e_s > -30.0 && e_s < -20.0));
        CHECK(std::ranges::equal(report.recorded, seen.recorded));  // the vehicle knows nothing of it
        octets_whole += seen.earth.octets.size();
        octets += report.earth.octets.size();
        if (report.earth.station_out) CHECK(report.earth.octets.empty());
        if (e_s >= -30.1 && e_s <= -19.9) told.insert(told.end(), report.links.begin(), report.links.end());
    }
    CHECK(octets <= octets_whole);
    REQUIRE(told.size() >= 2);
    CHECK(told.front().reason == "station out");
    CHECK_FALSE(told.front().up);
    const auto up_again = std::ranges::count_if(told, [](const LinkTruth& link) { return link.up; });
    CHECK(up_again == std::ranges::count(told, std::string{"station out"}, &LinkTruth::reason));
    const auto x_band = std::ranges::find(told, telemetry::x_band_link, &LinkTruth::link);
    REQUIRE(x_band != told.end());
    CHECK(x_band->reason == "station out");
}

}  // namespace simulation_landing_test
