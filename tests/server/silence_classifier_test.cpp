// SPDX-License-Identifier: Apache-2.0
#include "server/station/silence_classifier.hpp"

#include "server/rehearsal/rehearsal.hpp"
#include "tests/server/running_server.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <cstdlib>
#include <map>

namespace server_silence_classifier_test {

using namespace aeolis;
using namespace aeolis::server;

namespace {

constexpr Ert entry{1'000'000'000};
Ert at(double e_s) {
    return {entry.microseconds + static_cast<std::int64_t>(e_s * 1e6)};
}

PredictedSilences predicted() {
    PredictedSilences silences;
    silences.blackout = {45.0, 98.0};
    silences.hand_over_s = 247.0;
    silences.uhf_stop_s = 450.0;
    silences.earth_set_s = 300.0;
    return silences;
}

simulation::LinkState down(const simulation::Link& link, double e_s) {
    return {link, at(e_s), false, "what the simulation knows"};
}

/// How a link that goes down then is told.
std::string words(const simulation::Link& link, double e_s, const PredictedSilences& silences = predicted(),
                  const SilenceClassifier::Station& station = {}) {
    SilenceClassifier classifier{silences, at(-1200.0), entry};
    const auto told = classifier.tell({down(link, e_s)}, at(e_s), station);
    REQUIRE(told.size() == 1);
    CHECK_FALSE(told[0].up);
    CHECK(told[0].lost == told[0].reason.starts_with("unexplained"));
    return told[0].reason;
}

/// The class that ground should find for what the simulation says.
std::string expected(const std::string& truth) {
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
std::vector<Told> changes(const std::vector<simulation::LinkState>& links) {
    std::vector<Told> all;
    for (const auto& link : links)
        all.push_back({link.link.name, link.ert.microseconds, link.up, link.up ? link.reason : class_of(link.reason)});
    return all;
}

}  // namespace

TEST_CASE("a silence is named by what was predicted for its time, and by nothing that only the simulation knows",
          "[station][silence]") {
    CHECK(words(simulation::uhf_live_link, 44.6) == "plasma blackout: predicted from E+45 s to E+98 s");
    CHECK(words(simulation::uhf_live_link, 251.4) == "antenna hand-over: planned at E+247 s");
    CHECK(words(simulation::uhf_live_link, 456.4) == "switched off: planned at E+450 s");
    CHECK(words(simulation::uhf_live_link, -300.0) == "unexplained: nothing is predicted to silence it now");
    CHECK(words(simulation::x_band_link, 290.0) == "Earth set: predicted at E+300 s");
    CHECK(words(simulation::x_band_link, -20.0) == "unexplained: nothing is predicted to silence it now");
    auto weak = predicted();
    weak.carrier_weak = true;
    CHECK(words(simulation::x_band_link, -20.0, weak) ==
          "carrier too weak: the link's budget has it below what a lock needs");
    CHECK(words(simulation::relay_link, 500.0, predicted(), {1.0, {}}) == "recording complete");
    CHECK(words(simulation::relay_link, 500.0) == "unexplained: the recording is not complete");
    CHECK(words({"uhf_mro", false}, 2600.0) == "delivered: nothing more comes until the orbiter's next pass");
    // Where nothing explains it, what was heard last is told.
    CHECK(words(simulation::uhf_live_link, -300.0, predicted(), {0.0, {{"uhf_live", at(-301.2)}}}) ==
          "unexplained: nothing is predicted to silence it now; its last octet left at E−301 s");
}

TEST_CASE("a prediction counts as far as its margin, and no farther", "[station][silence]") {
    const double margin_s = SilenceClassifier::margin_s;
    CHECK(class_of(words(simulation::uhf_live_link, 45.0 - margin_s)) == "plasma blackout");
    CHECK(class_of(words(simulation::uhf_live_link, 44.9 - margin_s)) == "unexplained");
    CHECK(class_of(words(simulation::uhf_live_link, 98.0 + margin_s)) == "plasma blackout");
    CHECK(class_of(words(simulation::uhf_live_link, 98.1 + margin_s)) == "unexplained");
    CHECK(class_of(words(simulation::x_band_link, 299.9 - margin_s)) == "unexplained");
}

TEST_CASE("orbiters explain a silence by their passes: none in view, or one that delivers later",
          "[station][silence]") {
    auto silences = predicted();
    const auto pass = [&](const char* orbiter, double rise_s, double set_s) -> simulation::RelayPass& {
        auto& added = silences.passes.emplace_back();
        added.orbiter = orbiter;
        added.rise_after_entry_s = rise_s;
        added.set_after_entry_s = set_s;
        return added;
    };
    pass("odyssey", -1200.0, 200.0);
    auto& mro = pass("mro", -300.0, 400.0);
    mro.stored = true;
    mro.delivery_after_set_s = 1800.0;
    pass("odyssey", 7200.0, 7800.0);
    CHECK(words(simulation::uhf_live_link, 210.0, silences) == "orbiter records: mro delivers from E+2200 s");
    CHECK(words(simulation::relay_link, 600.0, silences) == "no orbiter in view: odyssey rises at E+7200 s");
    CHECK(words(simulation::relay_link, 9000.0, silences) == "no orbiter in view: no further pass is planned");
    CHECK(class_of(words(simulation::uhf_live_link, 60.0, silences)) == "plasma blackout");  // odyssey is in view
}

TEST_CASE("a silence that outlasts what explained it becomes unexplained, once", "[station][silence]") {
    SilenceClassifier classifier{predicted(), at(-1200.0), entry};
    REQUIRE(classifier.tell({down(simulation::uhf_live_link, 45.0)}, at(45.0), {}).size() == 1);
    std::vector<Told> later;
    for (double e_s = 46.0; e_s < 200.0; e_s += 1.0)
        for (const auto& told : changes(classifier.tell({}, at(e_s), {}))) later.push_back(told);
    CHECK(later ==
          std::vector<Told>{{"uhf_live", at(99.0 + SilenceClassifier::margin_s).microseconds, false, "unexplained"}});
    // Once it is heard again there is nothing left to explain.
    const auto up = classifier.tell({{simulation::uhf_live_link, at(200.0), true, "nominal"}}, at(200.0), {});
    REQUIRE(up.size() == 1);
    CHECK(up[0].reason == "nominal");
    CHECK_FALSE(up[0].lost);
    CHECK(classifier.tell({}, at(300.0), {}).empty());
}

TEST_CASE(
    "what nothing predicted while the station fails is a ground fault, and again unexplained when the station is back",
    "[station][silence][faults]") {
    SilenceClassifier classifier{predicted(), at(-1200.0), entry};
    SilenceClassifier::Station out{0.0, {}, "nothing comes from the station"};
    const auto lost =
        classifier.tell({down(simulation::x_band_link, -100.0), down(simulation::uhf_live_link, 45.0)}, at(45.0), out);
    REQUIRE(lost.size() == 2);
    CHECK(lost[0].reason == "ground fault: nothing comes from the station");
    CHECK(lost[0].lost);
    CHECK(class_of(lost[1].reason) == "plasma blackout");  // which explains it as well
    const auto back = classifier.tell({}, at(50.0), {});
    REQUIRE(back.size() == 1);
    CHECK(back[0].link == simulation::x_band_link);
    CHECK(class_of(back[0].reason) == "unexplained");
}

TEST_CASE(
    "an orbiter's delivery that breaks off with the station is a ground fault, one that had ended stays delivered",
    "[station][silence][faults]") {
    SilenceClassifier classifier{predicted(), at(-1200.0), entry};
    const simulation::Link ended{"uhf_mex", false}, cut{"uhf_mro", false};
    REQUIRE(class_of(classifier.tell({down(ended, 2500.0)}, at(2500.0), {}).at(0).reason) == "delivered");
    const auto lost = classifier.tell({down(cut, 2600.0)}, at(2600.0), {0.0, {}, "nothing comes from the station"});
    REQUIRE(lost.size() == 1);
    CHECK(lost[0].link == cut);
    CHECK(lost[0].reason == "ground fault: nothing comes from the station");
    CHECK(lost[0].lost);
    const auto back = classifier.tell({}, at(2700.0), {});
    REQUIRE(back.size() == 1);
    CHECK(class_of(back[0].reason) == "delivered");
}

TEST_CASE("before anything can have come the silence is the light time's", "[station][silence]") {
    auto silences = predicted();
    silences.light_time_s = 828.0;
    SilenceClassifier classifier{silences, Ert{0}, entry};
    const auto first = classifier.tell({}, Ert{0}, {});
    REQUIRE(first.size() == 2);
    CHECK(first[0].reason == "light time: what leaves the vehicle at the start is here at 2000-001T12:13:48.000");
    CHECK(classifier.tell({}, Ert{827'000'000}, {}).empty());
    const auto late = classifier.tell({}, Ert{829'000'000}, {});  // and then nothing came
    REQUIRE(late.size() == 2);
    CHECK(class_of(late[0].reason) == "unexplained");
}

namespace {

/// Flies it twice, once as ground hears it and once with the simulation's reasons.
void check_silences(const char* name, std::uint64_t seed) {
    CAPTURE(name, seed);
    const auto scenario = test::shipped_scenario(name);
    Rehearsal rehearsal{scenario, seed, 0, tests::shipped_dictionary()};
    ScriptedLanding landing{scenario, seed, 0,
                            tests::shipped_dictionary()};  // the same flight, with the simulation's reasons
    std::vector<Told> found, truth;
    const auto add = [](std::vector<Told>& to, std::vector<Told> what) {
        to.insert(to.end(), what.begin(), what.end());
    };
    while (!rehearsal.finished()) {
        add(found, changes(rehearsal.step().links));
        const auto& report = landing.step();
        landing.hear(report);
        auto links = changes(report.links);
        for (auto& link : links)
            if (!link.up) link.reason = expected(link.reason);
        add(truth, std::move(links));
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
            if (!link.up) told.push_back(link.link.name + (link.lost ? " lost: " : ": ") + link.reason);
    REQUIRE(told.size() == 1);
    CHECK_THAT(told[0],
               Catch::Contains(
                   "uhf_live lost: unexplained: nothing is predicted to silence it now; its last octet left at E−30"));
}

TEST_CASE("a station's outage takes what came live meanwhile and nothing else: links are lost for a ground fault, the "
          "recording comes whole",
          "[station][silence][faults]") {
    auto scenario = test::shipped_scenario("nominal_auto");
    Rehearsal whole{scenario, 1, 0, tests::shipped_dictionary()};
    scenario.station_outages = {{200.0, 30.0}};
    Rehearsal cut{scenario, 1, 0, tests::shipped_dictionary()};
    std::size_t live = 0, live_whole = 0;
    const auto live_of = [](const simulation::CycleReport& report) {
        return static_cast<std::size_t>(
            std::ranges::count_if(report.packets, [](const auto& packet) { return !packet.link.recorded; }));
    };
    while (!whole.finished()) live_whole += live_of(whole.step());
    std::map<std::string, std::string> lost;
    while (!cut.finished()) {
        const auto& report = cut.step();
        live += live_of(report);
        for (const auto& link : report.links)
            if (link.lost) lost[link.link.name] += link.reason + "; ";
    }
    const std::string fault = "ground fault: nothing comes from the station; ";
    CHECK(lost == std::map<std::string, std::string>{{"uhf_live", fault}, {"x_band", fault}});
    CHECK(live < live_whole);
    CHECK(cut.recording_progress() == 1.0);
    CHECK(cut.digest() == whole.digest());
}

}  // namespace server_silence_classifier_test
