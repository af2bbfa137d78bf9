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
#include <fmt/format.h>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <utility>
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

/// X-band goes up and down when the receiver has found its carrier and lost it: for the same reasons as in truth,
/// except for what is shorter than a receiver takes to notice.
void check_x_band(const std::vector<Told>& found, std::vector<Told> truth) {
    constexpr std::int64_t found_after_us = 4'500'000, lost_after_us = 2'600'000, first_search_us = 10'200'000;
    std::string all_found, all_truth;
    for (const auto& each : found)
        all_found += fmt::format("{} {} {}\n", each.ert_us / 1000, each.up ? "up" : "down", each.reason);
    for (const auto& each : truth)
        all_truth += fmt::format("{} {} {}\n", each.ert_us / 1000, each.up ? "up" : "down", each.reason);
    CAPTURE(all_found, all_truth);
    for (std::size_t i = 0; i + 1 < truth.size();)
        if (!truth[i].up && i > 0 && truth[i + 1].ert_us - truth[i].ert_us < 1'500'000)
            truth.erase(truth.begin() + static_cast<std::ptrdiff_t>(i),
                        truth.begin() + static_cast<std::ptrdiff_t>(i) + 2);
        else
            ++i;
    REQUIRE(found.size() == truth.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        CAPTURE(i);
        CHECK((found[i].up == truth[i].up && found[i].reason == truth[i].reason));
        const auto late_us = found[i].ert_us - truth[i].ert_us;
        CHECK(late_us >= 0);
        CHECK(late_us <= (i == 0 ? first_search_us : found[i].up ? found_after_us : lost_after_us));
    }
}

/// Flies it and compares what ground tells with the simulation's reasons.
void check_silences(const char* name, std::uint64_t seed) {
    CAPTURE(name, seed);
    const auto scenario = test::shipped_scenario(name);
    Rehearsal rehearsal{scenario, seed, 0, tests::shipped_dictionary()};
    std::vector<Told> found, truth, x_band_found, x_band_truth;
    const auto is_x_band = [](const auto& link) { return link == telemetry::x_band_link.name; };
    while (!rehearsal.finished()) {
        for (auto& each : changes(rehearsal.step().links))
            (is_x_band(each.link) ? x_band_found : found).push_back(std::move(each));
        for (const auto& link : rehearsal.landing().report().links)
            (is_x_band(link.link.name) ? x_band_truth : truth)
                .push_back({link.link.name, link.ert.microseconds, link.up,
                            link.up ? link.reason : expected(link.link.name, link.reason, rehearsal.clocks().e_s())});
    }
    CHECK(found.size() >= 5);
    check_x_band(x_band_found, x_band_truth);
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
constexpr double drag_mps2 = 0.02 * 9.80665;  ///< from there on drag is there

/// @param until_e_s  what comes later is not flown
Features features_of(const simulation::Scenario& scenario, std::uint64_t seed, std::uint64_t case_number = 0,
                     double until_e_s = 1e9) {
    Rehearsal rehearsal{scenario, seed, case_number, tests::shipped_dictionary()};
    const auto& landing = rehearsal.landing();
    const double to_entry_s =
        static_cast<double>(landing.correlation().scet_of(scenario.entry_sclk).microseconds) * 1e-6 +
        landing.light_time_s();
    const auto e_s = [&](Ert ert) { return static_cast<double>(ert.microseconds) * 1e-6 - to_entry_s; };
    Features found;
    while (!rehearsal.finished() && rehearsal.clocks().e_s() < until_e_s) {
        for (const auto& seen : rehearsal.step().seen) {
            found.told_seen_s[seen.feature] = {e_s(seen.ert), e_s(seen.at)};
            ++found.told;
            CHECK(std::abs(seen.evidence_hz) > 4.0 * seen.sigma_hz);
        }
        for (const auto& event : landing.report().events) found.true_s[event.name] = event.e_s;
        if (const auto truth = landing.truth(); truth.e_s > 0.0 && truth.sensed_mps2 > drag_mps2)
            found.true_s.try_emplace("drag", truth.e_s);
    }
    return found;
}

constexpr double turning_s = 4.5;  ///< lift begins to turn that much before it changes sides

void check_features(const Features& found, double within_s = 3.5) {
    using enum telemetry::SeenByDoppler::Feature;
    REQUIRE(found.told_seen_s.contains(entry));
    REQUIRE(found.told_seen_s.contains(parachute));
    REQUIRE(found.told_seen_s.contains(heatshield));
    CHECK(found.told == found.told_seen_s.size());
    CHECK(found.told_seen_s.at(entry).second == Approx(30.5).margin(2.0));
    for (const auto& [feature, event] : {std::pair{first_reversal, "bank_reversal_1"},
                                         {second_reversal, "bank_reversal_2"},
                                         {third_reversal, "bank_reversal_3"}}) {
        CAPTURE(event);
        REQUIRE(found.told_seen_s.contains(feature) == found.true_s.contains(event));
        if (!found.true_s.contains(event)) continue;
        const double sides_change_s = found.true_s.at(event);
        const auto [told_s, seen_s] = found.told_seen_s.at(feature);
        CAPTURE(sides_change_s, seen_s, told_s);
        CHECK(seen_s > sides_change_s - turning_s);
        CHECK(told_s < sides_change_s + within_s);
    }
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
          "[station][silence][R53]") {
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

// GNC alone, the statistical carrier at 22 dB-Hz throughout, neither outages nor hand-over. Each landing is heard
// twice: as flown, and with the lift's turns taken out of its Doppler, where a reversal that is told is false. The
// figures are those of docs/tones.md.
TEST_CASE("over 500 dispersed landings each feature of the flight is seen by Doppler, in time and never too early",
          "[.long][station][R53]") {
    constexpr double c_n0_dbhz = 22.0, earth_sets_s = 296.0, light_mps = 299'792'458.0;
    constexpr double in_time_s = 3.0, braking_from_s = 60.0, braking_to_s = 145.0;
    constexpr std::uint64_t seed = 7;
    constexpr std::size_t count = 6, first_reversal = 3;
    constexpr std::array names{
        "drag", "parachute_deploy", "heatshield_separation", "bank_reversal_1", "bank_reversal_2", "bank_reversal_3"};
    constexpr std::array steps{0.13, -0.21, 0.14};  // of the rate's logarithm, in the undispersed flight
    const auto& mfsk = tests::shipped_dictionary().mfsk;
    auto scenario = test::shipped_scenario("nominal_auto");
    const auto predicted = predicted_flight(scenario, mfsk);
    const auto& predict_hz = predicted.doppler_hz;
    scenario.disperse_before_entry_s.reset();
    scenario.test_venue = simulation::TestVenue::gnc_alone;
    scenario.radio = {};
    scenario.start_before_entry_s = 700.0;
    std::array<std::vector<double>, count> late_s;
    std::array<int, count> missed{}, too_early{};
    int untrue = 0, without_reversal = 0;
    using Seen = std::map<std::size_t, double>;
    const auto hear = [&](const std::vector<std::pair<double, double>>& doppler_hz, std::uint64_t landing_number) {
        simulation::CarrierModel receiver{c_n0_dbhz, predict_hz, seed, landing_number};
        telemetry::DopplerWatch watch{predict_hz, Ert{}, predicted.reversals_s};
        Seen seen_s;
        for (const auto& [e_s, hz] : doppler_hz) {
            simulation::XBandField field;
            field.ert = {std::llround(e_s * 1.0e6)};
            field.e_s = e_s;
            field.doppler_hz = hz;
            field.up = true;
            const auto carrier = receiver.hear(field);
            if (!carrier) continue;
            if (const auto seen = watch.hear(*carrier))
                CHECK(seen_s
                          .emplace(static_cast<std::size_t>(seen->feature),
                                   static_cast<double>(seen->ert.microseconds) * 1.0e-6)
                          .second);
        }
        return seen_s;
    };
    for (std::uint64_t landing_number = 0; landing_number < 500; ++landing_number) {
        CAPTURE(landing_number);
        simulation::Landing landing{scenario, seed, landing_number};
        std::array<std::optional<double>, count> there_s;
        std::vector<std::pair<double, double>> doppler_hz;
        // Also of heading alignment, which may turn the lift to its other side for the last time.
        std::vector<double> turns_s;
        double bank_deg = 0.0;
        while (landing.outcome() == simulation::Outcome::running && landing.truth().e_s < earth_sets_s + 2.0) {
            const auto truth = landing.truth();
            if (truth.e_s > -40.0)
                doppler_hz.emplace_back(
                    truth.e_s, -simulation::earth_range_rate_mps(simulation::vector3(truth.p_MoB_M_m),
                                                                 simulation::vector3(truth.v_MB_M_mps), truth.e_s) /
                                   light_mps * mfsk.carrier_hz);
            const double bank_before_deg = std::exchange(bank_deg, landing.inspect().bank_deg);
            if (truth.e_s > braking_from_s && truth.e_s < braking_to_s && bank_deg * bank_before_deg < 0.0)
                turns_s.push_back(truth.e_s);
            if (!there_s[0] && truth.e_s > 0.0 && truth.sensed_mps2 > drag_mps2) there_s[0] = truth.e_s;
            for (const auto& event : landing.step().events)
                for (std::size_t i = 1; i < count; ++i)
                    if (event.name == names[i]) there_s[i] = event.e_s;
        }
        auto straight_hz = doppler_hz;
        for (std::size_t i = 1; i < doppler_hz.size(); ++i) {
            double logarithm = 0.0;
            for (std::size_t k = 0; k < steps.size(); ++k)
                if (const auto& turned_s = there_s[first_reversal + k])
                    logarithm +=
                        steps[k] *
                        (0.5 + 0.5 * std::sin(std::numbers::pi *
                                              std::clamp((doppler_hz[i].first - *turned_s - 0.6) / 9.0, -0.5, 0.5)));
            const double gained_hz = doppler_hz[i].second - doppler_hz[i - 1].second;
            straight_hz[i].second =
                straight_hz[i - 1].second + gained_hz * (gained_hz > 0.0 ? std::exp(-logarithm) : 1.0);
        }
        const Seen seen_s = hear(doppler_hz, landing_number);
        for (std::size_t i = 0; i < count; ++i) {
            CAPTURE(names[i]);
            const bool told = seen_s.contains(i);
            if (!there_s[i] || *there_s[i] > earth_sets_s) {
                const bool turned = i >= first_reversal && told && std::ranges::any_of(turns_s, [&](double turn_s) {
                                        return std::abs(seen_s.at(i) - turn_s) < turning_s;
                                    });
                untrue += told && !turned ? 1 : 0;
                continue;
            }
            if (!told) {
                ++missed[i];
                continue;
            }
            const double began_s = *there_s[i] - (i >= first_reversal ? turning_s : 0.0);
            if (seen_s.at(i) <= began_s) ++too_early[i];
            late_s[i].push_back(seen_s.at(i) - *there_s[i]);
        }
        std::erase_if(turns_s, [&](double turn_s) {
            return std::ranges::any_of(there_s,
                                       [&](const auto& at_s) { return at_s && std::abs(*at_s - turn_s) < 1.0; });
        });
        for (const auto& [feature, at_s] : hear(straight_hz, landing_number))
            if (feature >= first_reversal &&
                std::ranges::none_of(turns_s, [&](double turn_s) { return std::abs(at_s - turn_s) < turning_s; }))
                ++without_reversal;
    }
    for (std::size_t i = 0; i < count; ++i) {
        std::ranges::sort(late_s[i]);
        const auto in_time = std::ranges::count_if(late_s[i], [](double each) { return each <= in_time_s; });
        std::printf("%s: %zu told, %d missed, %d too early; %.1f to %.1f s after it was there, %td within 3 s\n",
                    names[i], late_s[i].size(), missed[i], too_early[i], late_s[i].front(), late_s[i].back(), in_time);
        CHECK(missed[i] <= 5);
        CHECK(in_time * 100 >=
              static_cast<std::ptrdiff_t>(late_s[i].size() + static_cast<std::size_t>(missed[i])) * 99);
    }
    std::printf("%d told that were not there; %d reversals told where they were taken out\n", untrue, without_reversal);
    CHECK(untrue + std::accumulate(too_early.begin(), too_early.end(), 0) <= 1);
    CHECK(without_reversal <= 5);  // of 1500
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
    for (const auto& [samples, c_n0_dbhz] : {std::pair{true, 5.0}, {false, 5.0}, {false, 13.0}}) {
        CAPTURE(samples, c_n0_dbhz);
        auto scenario = test::shipped_scenario("nominal_auto");
        scenario.start_before_entry_s = 900.0;
        scenario.commands[0].send_before_entry_s = 895.0;
        scenario.commands[1].send_before_entry_s = 885.0;
        scenario.radio.tones_from_samples = samples;
        scenario.radio.x_band_c_n0_dbhz = c_n0_dbhz;
        Rehearsal rehearsal{scenario, 1, 0, tests::shipped_dictionary()};
        std::string told;
        while (rehearsal.clocks().e_s() < -600.0) {
            const auto& received = rehearsal.step();
            CHECK(received.tones.empty());
            CHECK(received.carrier.empty());
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

TEST_CASE("a landing's drag, reversals, parachute and heatshield are seen by Doppler within seconds, each once",
          "[station][tones][R54]") {
    check_features(features_of(test::shipped_scenario("nominal_auto"), 1));
}

TEST_CASE("features are seen by Doppler over landings that differ, and by the receiver of samples",
          "[.long][station][tones][R54]") {
    for (const std::uint64_t seed : {7U, 8U, 9U})
        check_features(features_of(test::shipped_scenario("nominal_auto"), seed));
    auto scenario = test::shipped_scenario("nominal_auto");
    scenario.radio.tones_from_samples = true;
    check_features(features_of(scenario, 1));
}

// The whole landing with its antennas and their hand-over, its blackout and Earth's set, tones from samples. The
// figures are those of docs/tones.md.
TEST_CASE("over twenty dispersed landings from samples at 24 dB-Hz features are seen by Doppler, and none that is not "
          "there",
          "[.long][station][tones][R54]") {
    constexpr std::uint64_t seed = 7, landings = 20;
    constexpr double in_time_s = 3.0, end_e_s = 310.0;
    auto scenario = test::shipped_scenario("nominal_auto");
    scenario.start_before_entry_s = 900.0;
    scenario.commands[0].send_before_entry_s = 895.0;
    scenario.commands[1].send_before_entry_s = 885.0;
    scenario.radio.tones_from_samples = true;
    scenario.radio.x_band_c_n0_dbhz = 24.0;
    using enum telemetry::SeenByDoppler::Feature;
    // When the parachute opens, the carrier swerves by up to 2000 Hz/s², and the antennas have just been handed over.
    struct Expected {
        telemetry::SeenByDoppler::Feature feature;
        const char* event;
        int missed_most;
        double latest_s;
    };
    constexpr std::array<Expected, 6> names{{{entry, "drag", 0, in_time_s},
                                             {first_reversal, "bank_reversal_1", 0, in_time_s},
                                             {second_reversal, "bank_reversal_2", 0, in_time_s},
                                             {third_reversal, "bank_reversal_3", 0, in_time_s},
                                             {parachute, "parachute_deploy", 0, 3.5},
                                             {heatshield, "heatshield_separation", 2, in_time_s}}};
    std::array<std::vector<double>, names.size()> late_s;
    std::array<int, names.size()> there{};
    int untrue = 0, too_early = 0;
    for (std::uint64_t landing = 1; landing <= landings; ++landing) {
        CAPTURE(landing);
        const Features found = features_of(scenario, seed, landing, end_e_s);
        CHECK(found.told == found.told_seen_s.size());
        for (std::size_t i = 0; i < names.size(); ++i) {
            CAPTURE(names[i].event);
            const auto true_s = found.true_s.find(names[i].event);
            const auto told = found.told_seen_s.find(names[i].feature);
            there[i] += true_s != found.true_s.end() ? 1 : 0;
            if (told == found.told_seen_s.end()) continue;
            if (true_s == found.true_s.end()) {
                ++untrue;
                continue;
            }
            const bool reversal = i >= 1 && i <= 3;
            too_early += told->second.second <= true_s->second - (reversal ? turning_s : 0.0) ? 1 : 0;
            late_s[i].push_back(told->second.first - true_s->second);
        }
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
        std::ranges::sort(late_s[i]);
        const auto within = [&](double most_s) {
            return std::ranges::count_if(late_s[i], [&](double each) { return each <= most_s; });
        };
        std::printf("%s: %zu told of %d; %.1f to %.1f s after it was there, %td within 3 s\n", names[i].event,
                    late_s[i].size(), there[i], late_s[i].empty() ? 0.0 : late_s[i].front(),
                    late_s[i].empty() ? 0.0 : late_s[i].back(), within(in_time_s));
        CHECK(there[i] - static_cast<int>(late_s[i].size()) <= names[i].missed_most);
        CHECK(within(names[i].latest_s) == std::ssize(late_s[i]));
    }
    std::printf("%d told that were not there, %d too early\n", untrue, too_early);
    CHECK(untrue + too_early == 0);
}

}  // namespace server_heard_landing_test
