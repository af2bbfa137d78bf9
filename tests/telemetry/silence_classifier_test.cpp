// SPDX-License-Identifier: Apache-2.0
#include "telemetry/station/silence_classifier.hpp"

#include "tests/support/catch.hpp"

#include <string>
#include <vector>

namespace telemetry_silence_classifier_test {

using namespace aeolis;
using namespace aeolis::telemetry;

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

LinkState down(const Link& link, double e_s) {
    return {link, at(e_s), false, ""};
}

/// How a link that goes down then is told.
std::string words(const Link& link, double e_s, const PredictedSilences& silences = predicted(),
                  const SilenceClassifier::Station& station = {}) {
    SilenceClassifier classifier{silences, at(-1200.0), entry};
    const auto told = classifier.tell({down(link, e_s)}, at(e_s), station);
    REQUIRE(told.size() == 1);
    CHECK_FALSE(told[0].up);
    CHECK(told[0].lost == told[0].reason().starts_with("unexplained"));
    return told[0].reason();
}

std::string class_of(const std::string& reason) {
    return reason.substr(0, reason.find(':'));
}

}  // namespace

TEST_CASE("a silence is named by what was predicted for its time, and by nothing that only the simulation knows",
          "[station][silence]") {
    CHECK(words(uhf_live_link, 44.6) == "plasma blackout: predicted from E+0:45 to E+1:38");
    CHECK(words(uhf_live_link, 251.4) == "antenna hand-over: planned at E+4:07");
    CHECK(words(uhf_live_link, 456.4) == "switched off: planned at E+7:30");
    CHECK(words(uhf_live_link, -300.0) == "unexplained: nothing is predicted to silence it now");
    CHECK(words(x_band_link, 290.0) == "Earth set: predicted at E+5:00");
    CHECK(words(x_band_link, -20.0) == "unexplained: nothing is predicted to silence it now");
    auto weak = predicted();
    weak.carrier_weak = true;
    CHECK(words(x_band_link, -20.0, weak) == "carrier too weak: the link's budget has it below what a lock needs");
    CHECK(words(relay_link, 500.0, predicted(), {1.0, {}}) == "recording complete");
    CHECK(words(relay_link, 500.0) == "unexplained: the recording is not complete");
    CHECK(words({"uhf_mro", false}, 2600.0) == "delivered: nothing more comes until the orbiter's next pass");
    // Where nothing explains it, what was heard last is told.
    CHECK(words(uhf_live_link, -300.0, predicted(), {0.0, {{"uhf_live", at(-301.2)}}}) ==
          "unexplained: nothing is predicted to silence it now; its last octet left at E−5:02");
}

TEST_CASE("a prediction counts as far as its margin, and no farther", "[station][silence]") {
    const double margin_s = SilenceClassifier::margin_s;
    CHECK(class_of(words(uhf_live_link, 45.0 - margin_s)) == "plasma blackout");
    CHECK(class_of(words(uhf_live_link, 44.9 - margin_s)) == "unexplained");
    CHECK(class_of(words(uhf_live_link, 98.0 + margin_s)) == "plasma blackout");
    CHECK(class_of(words(uhf_live_link, 98.1 + margin_s)) == "unexplained");
    CHECK(class_of(words(x_band_link, 299.9 - margin_s)) == "unexplained");
}

TEST_CASE("orbiters explain a silence by their passes: none in view, or one that delivers later",
          "[station][silence]") {
    auto silences = predicted();
    silences.passes = {{"odyssey", -1200.0, 200.0, 200.0, false},
                       {"mro", -300.0, 400.0, 2200.0, true},
                       {"odyssey", 7200.0, 7800.0, 7800.0, false}};
    CHECK(words(uhf_live_link, 210.0, silences) == "orbiter records: mro delivers from E+36:40");
    CHECK(words(relay_link, 600.0, silences) == "no orbiter in view: odyssey rises at E+2:00:00");
    CHECK(words(relay_link, 9000.0, silences) == "no orbiter in view: no further pass is planned");
    CHECK(class_of(words(uhf_live_link, 60.0, silences)) == "plasma blackout");  // odyssey is in view
}

TEST_CASE("a silence that outlasts what explained it becomes unexplained, once", "[station][silence]") {
    SilenceClassifier classifier{predicted(), at(-1200.0), entry};
    REQUIRE(classifier.tell({down(uhf_live_link, 45.0)}, at(45.0), {}).size() == 1);
    std::vector<LinkState> later;
    for (double e_s = 46.0; e_s < 200.0; e_s += 1.0)
        for (const auto& told : classifier.tell({}, at(e_s), {})) later.push_back(told);
    REQUIRE(later.size() == 1);
    CHECK(later[0].link == uhf_live_link);
    CHECK(later[0].ert == at(99.0 + SilenceClassifier::margin_s));
    CHECK_FALSE(later[0].up);
    CHECK(class_of(later[0].reason()) == "unexplained");
    // Once it is heard again there is nothing left to explain.
    const auto up = classifier.tell({{uhf_live_link, at(200.0), true, "nominal"}}, at(200.0), {});
    REQUIRE(up.size() == 1);
    CHECK(up[0].reason() == "nominal");
    CHECK_FALSE(up[0].lost);
    CHECK(classifier.tell({}, at(300.0), {}).empty());
}

TEST_CASE(
    "what nothing predicted while the station fails is a ground fault, and again unexplained when the station is back",
    "[station][silence][faults]") {
    SilenceClassifier classifier{predicted(), at(-1200.0), entry};
    SilenceClassifier::Station out{0.0, {}, "nothing comes from the station"};
    const auto lost = classifier.tell({down(x_band_link, -100.0), down(uhf_live_link, 45.0)}, at(45.0), out);
    REQUIRE(lost.size() == 2);
    CHECK(lost[0].reason() == "ground fault: nothing comes from the station");
    CHECK(lost[0].lost);
    // A prediction explains it as well, but does not excuse the fault.
    CHECK(lost[1].reason() == "plasma blackout: predicted from E+0:45 to E+1:38; nothing comes from the station");
    CHECK(lost[1].lost);
    const auto back = classifier.tell({}, at(50.0), {});
    REQUIRE(back.size() == 1);
    CHECK(back[0].reason() == "plasma blackout: predicted from E+0:45 to E+1:38");
    CHECK_FALSE(back[0].lost);
    // The receiver has had to search for its carrier again.
    const auto searched = classifier.tell({}, at(55.5), {});
    REQUIRE(searched.size() == 1);
    CHECK(searched[0].link == x_band_link);
    CHECK(class_of(searched[0].reason()) == "unexplained");
}

TEST_CASE(
    "an orbiter's delivery that breaks off with the station is a ground fault, one that had ended stays delivered",
    "[station][silence][faults]") {
    SilenceClassifier classifier{predicted(), at(-1200.0), entry};
    const Link ended{"uhf_mex", false}, cut{"uhf_mro", false};
    REQUIRE(class_of(classifier.tell({down(ended, 2500.0)}, at(2500.0), {}).at(0).reason()) == "delivered");
    const auto lost = classifier.tell({down(cut, 2600.0)}, at(2600.0), {0.0, {}, "nothing comes from the station"});
    REQUIRE(lost.size() == 1);
    CHECK(lost[0].link == cut);
    CHECK(lost[0].reason() == "ground fault: nothing comes from the station");
    CHECK(lost[0].lost);
    const auto back = classifier.tell({}, at(2700.0), {});
    REQUIRE(back.size() == 1);
    CHECK(class_of(back[0].reason()) == "delivered");
}

TEST_CASE("a silence that is predicted to end says when: blackout, the next pass, a delivery", "[station][silence]") {
    const auto until = [](const Link& link, double e_s, const PredictedSilences& silences) {
        SilenceClassifier classifier{silences, at(-1200.0), entry};
        return classifier.tell({down(link, e_s)}, at(e_s), {}).at(0).until;
    };
    auto silences = predicted();
    CHECK(until(uhf_live_link, 50.0, silences) == at(98.0));
    CHECK_FALSE(until(uhf_live_link, 456.0, silences));  // switched off for good
    CHECK_FALSE(until(x_band_link, 300.0, silences));
    silences.passes = {{"mro", -300.0, 400.0, 2200.0, true}, {"odyssey", 7200.0, 7800.0, 7800.0, false}};
    CHECK(until(uhf_live_link, 210.0, silences) == at(2200.0));
    CHECK(until(relay_link, 600.0, silences) == at(7200.0));
    CHECK_FALSE(until(relay_link, 9000.0, silences));
}

TEST_CASE("what the plan has yet to switch on is no loss, and what it does not bring when due is one",
          "[station][silence]") {
    auto silences = predicted();
    silences.uhf_start_s = -800.0;
    silences.x_band_tones_s = -750.0;
    const std::string uhf = "not begun: planned at E−13:20", tones = "not begun: X-band sends telemetry until E−12:30";
    CHECK(words(uhf_live_link, -1200.0, silences) == uhf);
    CHECK(words(x_band_link, -1200.0, silences) == tones);
    auto without_orbiter = silences;
    without_orbiter.passes = {{"odyssey", 7200.0, 7800.0, 7800.0, false}};
    CHECK(words(uhf_live_link, -801.0, without_orbiter) == uhf);
    CHECK(class_of(words(uhf_live_link, -799.0, without_orbiter)) == "no orbiter in view");
    CHECK(class_of(words(x_band_telemetry_link, -1200.0, silences)) == "unexplained");
    SilenceClassifier classifier{silences, at(-1200.0), entry};
    const auto begun = classifier.tell({down(uhf_live_link, -1200.0), down(x_band_link, -1200.0)}, at(-1200.0), {});
    REQUIRE(begun.size() == 2);
    CHECK(begun[0].until == at(-800.0));
    CHECK(begun[1].until == at(-750.0));
    CHECK(classifier.tell({}, at(-800.0 + SilenceClassifier::margin_s - 0.1), {}).empty());
    const auto missed = classifier.tell({}, at(-800.0 + SilenceClassifier::margin_s), {});
    REQUIRE(missed.size() == 1);
    CHECK(missed[0].link == uhf_live_link);
    CHECK(missed[0].lost);
    CHECK(classifier.tell({{x_band_link, at(-749.0), true, "nominal"}}, at(-749.0), {}).size() == 1);
}

TEST_CASE("X-band's telemetry ends by the clock, with the tones, and is lost when it ends earlier",
          "[station][silence]") {
    auto silences = predicted();
    silences.x_band_tones_s = -750.0;
    constexpr double margin_s = SilenceClassifier::pass_margin_s;
    CHECK(words(x_band_telemetry_link, -749.9, silences) == "switched off: X-band sends tones from E−12:30");
    CHECK(class_of(words(x_band_telemetry_link, -750.0 - margin_s, silences)) == "switched off");
    CHECK(class_of(words(x_band_telemetry_link, -750.1 - margin_s, silences)) == "unexplained");
}

TEST_CASE("before anything can have come the silence is the light time's", "[station][silence]") {
    auto silences = predicted();
    silences.light_time_s = 828.0;
    SilenceClassifier classifier{silences, Ert{0}, entry};
    const auto first = classifier.tell({}, Ert{0}, {});
    REQUIRE(first.size() == 2);
    CHECK(first[0].reason() == "light time: what leaves the vehicle at the start is here at 2000-001T12:13:48.000");
    CHECK(classifier.tell({}, Ert{827'000'000}, {}).empty());
    const auto late = classifier.tell({}, Ert{829'000'000}, {});  // and then nothing came
    REQUIRE(late.size() == 2);
    CHECK(class_of(late[0].reason()) == "unexplained");
}

}  // namespace telemetry_silence_classifier_test
