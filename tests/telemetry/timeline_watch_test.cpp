// SPDX-License-Identifier: Apache-2.0
#include "telemetry/timeline_watch.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>

namespace telemetry_timeline_watch_test {

using namespace aeolis;
using telemetry::TimelineWatch;

namespace {

ToneId tone_named(const std::string& name) {
    const auto& tones = tests::shipped_dictionary().tones;
    return std::ranges::find(tones, name, &dictionary::ToneRow::name)->id;
}
TimepointId id_of(std::size_t row) {
    return TimepointId{static_cast<std::uint16_t>(row)};
}

}  // namespace

TEST_CASE("a firing by packet moves the prediction of what follows, a tone does not", "[situation]") {
    TimelineWatch watch{tests::shipped_dictionary()};
    const auto parachute = *watch.row_of("parachute_deploy"), heatshield = *watch.row_of("heatshield_separation"),
               touchdown = *watch.row_of("touchdown");
    const double foreseen_s = *watch.foreseen_e_s(touchdown);
    CHECK(foreseen_s == Approx(431.47));
    CHECK_FALSE(watch.last());

    const auto told = watch.tone(tone_named("parachute_deploy"), 0.999, 262.0, 7);
    REQUIRE(told);
    CHECK(told->value == parachute);
    CHECK(watch.known(parachute)->by_tone);
    CHECK(watch.last() == parachute);
    CHECK(*watch.predicted_e_s(touchdown) == foreseen_s);
    CHECK_FALSE(watch.tone(tone_named("parachute_deploy"), 0.999, 272.0, 8));  // its second symbol

    watch.fired(id_of(parachute), 258.0, 258.0, false, 9);
    CHECK_FALSE(watch.known(parachute)->by_tone);
    CHECK(watch.known(parachute)->e_s == 258.0);
    CHECK(*watch.predicted_e_s(heatshield) == Approx(277.35 + 258.0 - 255.9));
    CHECK(*watch.foreseen_e_s(touchdown) == foreseen_s);
}

TEST_CASE("a tone of Second Chance tells what its twin of prime tells", "[situation][R35]") {
    TimelineWatch watch{tests::shipped_dictionary()};
    const auto told = watch.tone(tone_named("sc_touchdown"), 0.999, 440.0, 3);
    REQUIRE(told);
    CHECK(told->value == *watch.row_of("touchdown"));
}

TEST_CASE("the next step is the next that a tone announces, behind all that are known", "[situation]") {
    TimelineWatch watch{tests::shipped_dictionary()};
    const auto& timeline = tests::shipped_dictionary().timeline;
    CHECK(timeline[*watch.next()].tone);
    watch.fired(id_of(*watch.row_of("heatshield_separation")), 280.0, 280.0, false, 1);
    CHECK(timeline[*watch.next()].name == "radar_processing");  // thrusters_on between them has no tone
    watch.fired(id_of(timeline.size() - 1), 470.0, 470.0, false, 2);
    CHECK_FALSE(watch.next());
}

}  // namespace telemetry_timeline_watch_test
