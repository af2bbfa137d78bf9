// SPDX-License-Identifier: Apache-2.0
// Whole landings as ground hears them: tones by its own receiver, silences by its own reasons.
#include "server/rehearsal/predicted_doppler.hpp"
#include "server/rehearsal/rehearsal.hpp"
#include "simulation/links/carrier_model.hpp"
#include "simulation/mars/earth.hpp"
#include "telemetry/station/doppler_watch.hpp"
#include "tests/server/running_server.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace server_heard_landing_test {

using namespace aeolis;
using namespace aeolis::server;

namespace {

/// The class that ground should find for what the simulation says of a link.
std::string expected(const std::string& link, const std::string& truth, double e_s) {
    // UHF and tones are switched on by the timeline; what is off later was on.
    constexpr double all_begun_e_s = -700.0;
    if (truth == "not switched on" && e_s < all_begun_e_s && link != telemetry::x_band_telemetry_link.name)
        return "not begun";
    static const std::map<std::string, std::string> classes{{"plasma blackout", "plasma blackout"},
                                                            {"antenna hand-over", "antenna hand-over"},
                                                            {"not switched on", "switched off"},
                                                            {"computer off", "switched off"},
                                                            {"Earth set", "Earth set"},
                                                            {"no orbiter in view", "no orbiter in view"},
                                                            {"recording complete", "recording complete"},
                                                            {"delivered", "delivered"},
                                                            {"by mro, which delivers later", "orbiter records"}};
    const auto found = classes.find(truth);
    return found == classes.end() ? "unexplained" : found->second;
}

std::string class_of(const std::string& reason) {
    return reason.substr(0, reason.find(':'));
}

struct Told {
    std::string link;
    std::int64_t ert_us;
    bool up;
    std::string reason;
    bool operator==(const Told&) const = default;
};
std::vector<Told> changes(const std::vector<telemetry::LinkState>& links) {
    std::vector<Told> all;
    for (const auto& link : links)
        all.push_back({link.link.name, link.ert.microseconds, link.up, link.up ? link.words : class_of(link.reason())});
    return all;
}

/// Flies it and compares what ground tells with the simulation's reasons.
void check_silences(const char* name, std::uint64_t seed) {
    CAPTURE(name, seed);
    const auto scenario = test::shipped_scenario(name);
    Rehearsal rehearsal{scenario, seed, 0, tests::shipped_dictionary()};
    std::vector<Told> found, truth;
    const auto add = [](std::vector<Told>& to, std::vector<Told> what) {
        to.insert(to.end(), what.begin(), what.end());
    };
    while (!rehearsal.finished()) {
        add(found, changes(rehearsal.step().links));
        for (const auto& link : rehearsal.landing().report().links)
            truth.push_back({link.link.name, link.ert.microseconds, link.up,
                             link.up ? link.reason : expected(link.link.name, link.reason, rehearsal.clocks().e_s())});
    }
    CHECK(found.size() >= 6);
    std::string all_found, all_truth;
    for (const auto& each : found) all_found += each.link + (each.up ? " up " : " down ") + each.reason + "\n";
    for (const auto& each : truth) all_truth += each.link + (each.up ? " up " : " down ") + each.reason + "\n";
    REQUIRE(all_found == all_truth);
    for (std::size_t i = 0; i < found.size(); ++i) {
        CAPTURE(found[i].link, found[i].ert_us, found[i].reason, truth[i].reason);
        CHECK((found[i].link == truth[i].link && found[i].up == truth[i].up && found[i].reason == truth[i].reason));
        CHECK(std::abs(found[i].ert_us - truth[i].ert_us) <=
              1'000'000);  // a silence that becomes another is looked at each second
    }
}

/// When each feature is told that the Doppler of a landing shows, and when it was there, in seconds from entry.
struct Features {
    std::map<telemetry::SeenByDoppler::Feature, std::pair<double, double>> told_seen_s;
    std::map<std::string, double> true_s;
    std::size_t told = 0;
};
Features features_of(const simulation::Scenario& scenario, std::uint64_t seed) {
    Rehearsal rehearsal{scenario, seed, 0, tests::shipped_dictionary()};
    const auto& landing = rehearsal.landing();
    const double to_entry_s =
        static_cast<double>(landing.correlation().scet_of(scenario.entry_sclk).microseconds) * 1e-6 +
        landing.light_time_s();
    const auto e_s = [&](Ert ert) { return static_cast<double>(ert.microseconds) * 1e-6 - to_entry_s; };
    Features found;
    while (!rehearsal.finished()) {
        for (const auto& seen : rehearsal.step().seen) {
            found.told_seen_s[seen.feature] = {e_s(seen.ert), e_s(seen.at)};
            ++found.told;
            CHECK(seen.evidence_hz > 4.0 * seen.sigma_hz);
        }
        for (const auto& event : landing.report().events) found.true_s[event.name] = event.e_s;
    }
    return found;
}

void check_features(const Features& found, double within_s = 3.5) {
    using enum telemetry::SeenByDoppler::Feature;
    REQUIRE(found.told_seen_s.contains(entry));
    REQUIRE(found.told_seen_s.contains(parachute));
    REQUIRE(found.told_seen_s.contains(heatshield));
    CHECK(found.told == 3);
    CHECK(found.told_seen_s.at(entry).second == Approx(40.0).margin(6.0));
    for (const auto& [feature, event] :
         {std::pair{parachute, "parachute_deploy"}, {heatshield, "heatshield_separation"}}) {
        const double true_s = found.true_s.at(event);
        const auto [told_s, seen_s] = found.told_seen_s.at(feature);
        CAPTURE(event, true_s, seen_s, told_s);
        CHECK(seen_s > true_s);
        CHECK(told_s < true_s + within_s);
    }
}

}  // namespace

TEST_CASE("over landings that differ ground names each silence as the simulation has it, without being told",
          "[station][silence]") {
    check_silences("nominal_auto", 1);
    check_silences("relay_passes", 3);
    check_silences("od137", 1);
}

TEST_CASE("over more landings, with a reset and with other seeds, ground names each silence as the simulation has it",
          "[.long][station][silence]") {
    check_silences("second_chance", 2);
    for (const std::uint64_t seed : {7U, 8U, 9U}) check_silences("nominal_auto", seed);
    for (const std::uint64_t seed : {1U, 2U}) check_silences("relay_passes", seed);
}

// GNC alone, the statistical carrier at 22 dB-Hz throughout, neither outages nor hand-over. The figures are those of
// docs/tones.md.
TEST_CASE("over 500 dispersed landings each feature of the flight is seen by Doppler, in time and never too early",
          "[.long][station][R53]") {
    using Feature = telemetry::SeenByDoppler::Feature;
    constexpr double c_n0_dbhz = 22.0, earth_sets_s = 296.0, light_mps = 299'792'458.0;
    constexpr std::uint64_t seed = 7;
    constexpr std::array names{"entry", "parachute_deploy", "heatshield_separation"};
    const auto& mfsk = tests::shipped_dictionary().mfsk;
    auto scenario = test::shipped_scenario("nominal_auto");
    const auto predict_hz = predicted_doppler_hz(scenario, mfsk);
    scenario.disperse_before_entry_s.reset();
    scenario.test_venue = simulation::TestVenue::gnc_alone;
    scenario.radio = {};
    scenario.start_before_entry_s = 700.0;
    std::array<std::vector<double>, 3> late_s;
    std::array<int, 3> missed{};
    for (std::uint64_t landing_number = 0; landing_number < 500; ++landing_number) {
        CAPTURE(landing_number);
        simulation::Landing landing{scenario, seed, landing_number};
        simulation::CarrierModel receiver{c_n0_dbhz, predict_hz, seed, landing_number};
        telemetry::DopplerWatch watch{predict_hz, Ert{}};
        std::array<std::optional<double>, 3> seen_s, there_s{0.0};
        while (landing.outcome() == simulation::Outcome::running && landing.truth().e_s < earth_sets_s + 2.0) {
            const auto truth = landing.truth();
            simulation::XBandField field;
            field.ert = {std::llround(truth.e_s * 1.0e6)};
            field.e_s = truth.e_s;
            field.doppler_hz = -simulation::earth_range_rate_mps(simulation::vector3(truth.p_MoB_M_m),
                                                                 simulation::vector3(truth.v_MB_M_mps), truth.e_s) /
                               light_mps * mfsk.carrier_hz;
            field.up = true;
            if (const auto carrier = truth.e_s > -40.0 ? receiver.hear(field) : std::nullopt)
                if (const auto seen = watch.hear(*carrier)) {
                    const auto which = static_cast<std::size_t>(seen->feature);
                    CHECK_FALSE(seen_s[which]);
                    seen_s[which] = static_cast<double>(seen->ert.microseconds) * 1.0e-6;
                }
            for (const auto& event : landing.step().events)
                for (std::size_t i = 1; i < names.size(); ++i)
                    if (event.name == names[i]) there_s[i] = event.e_s;
        }
        for (std::size_t i = 0; i < names.size(); ++i) {
            CAPTURE(names[i]);
            if (!there_s[i] || *there_s[i] > earth_sets_s) continue;
            if (!seen_s[i]) {
                ++missed[i];
                continue;
            }
            CHECK(*seen_s[i] > *there_s[i]);
            late_s[i].push_back(*seen_s[i] - *there_s[i]);
        }
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
        std::ranges::sort(late_s[i]);
        const auto in_time = std::ranges::count_if(late_s[i], [](double each) { return each <= 3.0; });
        std::printf("%s: %zu told, %d missed; %.1f to %.1f s after it was there, %td within 3 s\n", names[i],
                    late_s[i].size(), missed[i], late_s[i].front(), late_s[i].back(), in_time);
        CHECK(missed[i] <= 5);
        const bool by_drag = static_cast<Feature>(i) == Feature::entry;  // which grows for half a minute
        if (!by_drag) CHECK(in_time * 100 >= static_cast<std::ptrdiff_t>(late_s[i].size()) * 99);
    }
}

TEST_CASE("a transmitter that fails where nothing is predicted is an unexplained silence", "[station][silence]") {
    auto scenario = test::shipped_scenario("nominal_auto");
    auto& fault = scenario.device_faults.emplace_back();
    fault.device = flight::Device::uhf;
    fault.unit = flight::Unit::a;
    fault.kind = simulation::DeviceFault::Kind::dropout;
    fault.begin_before_entry_s = 300.0;
    fault.duration_s = 100.0;
    Rehearsal rehearsal{scenario, 1, 0, tests::shipped_dictionary()};
    std::vector<std::string> told;
    while (!rehearsal.finished() && rehearsal.clocks().e_s() < -150.0)
        for (const auto& link : rehearsal.step().links)
            if (!link.up) told.push_back(link.link.name + (link.lost ? " lost: " : ": ") + link.reason());
    REQUIRE(told.size() == 4);  // before: UHF and tones not begun, X-band's telemetry switched off
    CHECK_THAT(told[3],
               Catch::Contains(
                   "uhf_live lost: unexplained: nothing is predicted to silence it now; its last octet left at E−5:0"));
}

TEST_CASE("a station's outage takes what came live meanwhile and nothing else: links are lost for a ground fault, the "
          "recording comes whole",
          "[station][silence][faults]") {
    auto scenario = test::shipped_scenario("nominal_auto");
    Rehearsal whole{scenario, 1, 0, tests::shipped_dictionary()};
    scenario.station_outages = {{200.0, 30.0}};
    Rehearsal cut{scenario, 1, 0, tests::shipped_dictionary()};
    std::size_t live = 0, live_whole = 0;
    const auto live_of = [](const telemetry::Received& report) {
        return static_cast<std::size_t>(
            std::ranges::count_if(report.packets, [](const auto& packet) { return !packet.link.recorded; }));
    };
    while (!whole.finished()) live_whole += live_of(whole.step());
    std::map<std::string, std::string> lost;
    while (!cut.finished()) {
        const auto& report = cut.step();
        live += live_of(report);
        for (const auto& link : report.links)
            if (link.lost) lost[link.link.name] += link.reason() + "; ";
    }
    const std::string fault = "ground fault: nothing comes from the station; ";
    CHECK(lost == std::map<std::string, std::string>{{"uhf_live", fault}, {"x_band", fault}});
    CHECK(live < live_whole);
    CHECK(cut.recording_progress() == 1.0);
    CHECK(cut.digest() == whole.digest());
}

TEST_CASE("a cold start at 5 dB-Hz leaves nothing of X-band but its silence, by samples as by the model",
          "[tones][station][R53]") {
    for (const bool samples : {true, false}) {
        CAPTURE(samples);
        auto scenario = test::shipped_scenario("nominal_auto");
        scenario.start_before_entry_s = 900.0;
        scenario.commands[0].send_before_entry_s = 895.0;
        scenario.commands[1].send_before_entry_s = 885.0;
        scenario.radio.tones_from_samples = samples;
        scenario.radio.x_band_c_n0_dbhz = 5.0;
        Rehearsal rehearsal{scenario, 1, 0, tests::shipped_dictionary()};
        std::string told;
        while (rehearsal.clocks().e_s() < -600.0) {
            const auto& received = rehearsal.step();
            CHECK(received.tones.empty());
            for (const auto& link : received.links)
                if (link.link == telemetry::x_band_link) told += (link.up ? "up " : "down ") + link.reason() + "\n";
        }
        CHECK(told == "down not begun: X-band sends telemetry until E−12:30\n"
                      "down carrier too weak: the link's budget has it below what a lock needs\n");
        const auto tones = rehearsal.tones();
        CHECK(tones.sent > 5);
        CHECK(tones.missed == tones.sent);
    }
}

TEST_CASE(
    "a landing's tones are decoded from its waveform, none wrong, and what UHF brought through bursts of errors is in "
    "the recording, bit for bit",
    "[tones][station][R31]") {
    auto scenario = test::shipped_scenario("nominal_auto");
    scenario.radio.tones_from_samples = true;
    scenario.radio.uhf_loss_fraction = 0.05;
    Rehearsal rehearsal{scenario, 1, 0, tests::shipped_dictionary()};
    std::set<std::string> outages;
    while (!rehearsal.finished())
        for (const auto& link : rehearsal.step().links)
            if (!link.up) outages.insert(link.link.name + ": " + link.reason());
    CHECK(rehearsal.outcome() == archive::Outcome::touchdown);
    CHECK(rehearsal.recording_progress() == 1.0);
    const auto silent = [&](const std::string& beginning) {
        return std::ranges::any_of(outages, [&](const auto& words) { return words.starts_with(beginning); });
    };
    CHECK(silent("uhf_live: plasma blackout: predicted"));
    CHECK(silent("x_band: Earth set: predicted"));
    CHECK(rehearsal.run_start(0.0).tone_model == "signal");
    const auto tones = rehearsal.tones();
    CHECK(tones.sent > 30);
    CHECK(tones.wrong == 0);
    CHECK(tones.missed <= 2);  // Earth sets in one, and the parachute may cost one
    const auto proof = rehearsal.proof();
    CHECK(proof.holds());
    CHECK(proof.realtime > 5000);
    const auto& links = rehearsal.station().links();
    const auto uhf = std::ranges::find(links, telemetry::uhf_live_link, &telemetry::GroundStation::LinkReceiver::link);
    REQUIRE(uhf != links.end());
    CHECK(uhf->pltus.counters().missing_frames > 10);
    CHECK(uhf->pltus.counters().bad_crc > 10);

    scenario.radio.tones_from_samples.reset();  // nobody chooses: drawn
    Rehearsal drawn{scenario, 1, 0, tests::shipped_dictionary()};
    while (!drawn.finished()) drawn.step();
    CHECK(drawn.run_start(0.0).tone_model == "statistical");
    CHECK(drawn.digest() == rehearsal.digest());  // what is recorded on board does not depend on who listens
}

TEST_CASE("a landing's drag, parachute and heatshield are seen by Doppler within seconds, each once",
          "[station][tones][R54]") {
    check_features(features_of(test::shipped_scenario("nominal_auto"), 1));
}

TEST_CASE("features are seen by Doppler over landings that differ, and by the receiver of samples",
          "[.long][station][tones][R54]") {
    for (const std::uint64_t seed : {7U, 8U, 9U})
        check_features(features_of(test::shipped_scenario("nominal_auto"), seed));
    auto scenario = test::shipped_scenario("nominal_auto");
    scenario.radio.tones_from_samples = true;
    check_features(features_of(scenario, 1), 10.0);  // after the hand-over its windows are 5 s
}

}  // namespace server_heard_landing_test
