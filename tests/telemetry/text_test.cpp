// SPDX-License-Identifier: Apache-2.0
#include "telemetry/text.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/small_dictionary.hpp"

namespace telemetry_text_test {

using namespace aeolis;
using namespace aeolis::telemetry;
using aeolis::tests::PacketFiller;

TEST_CASE("values read with their unit and as many digits as a person needs", "[text]") {
    CHECK(value_text(tests::f32("m/s"), 404.5678) == "404.6 m/s");
    CHECK(value_text(tests::f64("deg"), -4.5893) == "-4.59 deg");
    CHECK(value_text(tests::f64("1"), 0.24) == "0.24");
    CHECK(value_text(tests::u(16), 65535.0) == "65535");
    CHECK(value_text(tests::f64("m"), {}) == "undefined");
    CHECK(value_text(tests::f64("m/s"), -0.01) == "0.0 m/s");
    CHECK(value_text(tests::f64("furlong"), 1e300) == "1e+300 furlong");
}

TEST_CASE("enumerations read as labels and flags as true or false", "[text]") {
    const auto type = tests::labels(8, {{0, "pre_edl"}, {3, "landed"}});
    CHECK(value_text(type, 3.0) == "landed");
    CHECK(value_text(type, 7.0) == "7 (no label)");
    CHECK(value_text(tests::flag(), 1.0) == "true");
    CHECK(value_text(tests::flag(), 0.0) == "false");
}

TEST_CASE("the ending of a name gives the unit", "[text]") {
    CHECK(without_unit("speed_mps") == "speed");
    CHECK(without_unit("tone_priority") == "tone_priority");
    CHECK(without_unit("sclk") == "sclk");
    CHECK(named_value_text("speed_mps", 405.0) == "405.0 m/s");
    CHECK(named_value_text("tone_priority", 12.0) == "12");
    CHECK(named_value_text("mach", 1.75) == "1.75");
    CHECK(named_value_text("mach", 1.698765) == "1.70");
}

TEST_CASE("a span of time has tenths, and hours and minutes from an hour on", "[text]") {
    CHECK(span_text(9.04) == "9 s");
    CHECK(span_text(9.46875) == "9.5 s");
    CHECK(span_text(90.0) == "90 s");
    CHECK(span_text(7500.0) == "2 h 5 min");
    CHECK(span_text(-5.25) == "-5.3 s");
}

TEST_CASE("names, distances and times read as people say them", "[text][R38]") {
    CHECK(in_words("parachute_deploy") == "parachute deploy");
    CHECK(in_words("gnc_mode") == "GNC mode");
    CHECK(in_words("sufr_start") == "SUFR start");
    CHECK(in_words("x_band_tones") == "X-band tones");
    CHECK(in_words("") == "");
    CHECK(named_value_text("altitude_m", 99'999.9) == "99999.9 m");
    CHECK(named_value_text("solution_radius_m", 3'522'249.0) == "3522.2 km");
    CHECK(named_value_text("reply_wait_s", 0.5) == "0.5 s");
    CHECK(named_value_text("time_in_mode_s", 14.015625) == "14.016 s");
    CHECK(named_value_text("time_to_entry_s", 0.0) == "0 s");
    CHECK(named_value_text("time_to_entry_s", 3599.5) == "3599.5 s");
    CHECK(named_value_text("time_to_entry_s", 3600.0) == "1 h");
    CHECK(named_value_text("time_to_entry_s", 1189.515625) == "1189.5 s");
    CHECK(named_value_text("time_to_entry_s", 17964.25) == "4 h 59 min 24.3 s");
    CHECK(named_value_text("time_to_entry_s", 7199.9999) == "2 h");
    CHECK(named_value_text("time_to_entry_s", 86400.0) == "24 h");
    CHECK(named_value_text("time_to_entry_s", 604800.0) == "7 d");
    CHECK(named_value_text("time_to_entry_s", -525600.0) == "-6 d 2 h");
    CHECK(named_value_text("descent_rate_mps", 0.83) == "0.83 m/s");
    CHECK(named_value_text("time_to_separation_s", -3601.0) == "-1 h 1 s");
    CHECK(in_words("sub_constraint") == "sub-constraint");
    CHECK(in_words("sub_constraints") == "sub constraints");
}

TEST_CASE("a value and its bound are written with as many decimals as tell them apart", "[text][R38]") {
    using Texts = std::pair<std::string, std::string>;
    CHECK(told_apart("drag_mps2", 1.9634, 1.96) == Texts{"1.963 m/s2", "1.960 m/s2"});
    CHECK(told_apart("drag_mps2", 1.96, 1.96) == Texts{"1.96 m/s2", "1.96 m/s2"});
    CHECK(told_apart("speed_mps", 404.6, 405.0) == Texts{"404.6 m/s", "405.0 m/s"});
    CHECK(told_apart("speed_mps", 404.96, 405.0) == Texts{"404.96 m/s", "405.00 m/s"});
    CHECK(told_apart("elapsed_s", 21.0004, 21.0) == Texts{"21.0004 s", "21 s"});
    CHECK(told_apart("elapsed_s", 7200.04, 7200.0) == Texts{"2 h 0.04 s", "2 h"});
    CHECK(told_apart("radius_m", 3'522'201.0, 3'522'200.0) == Texts{"3522.201 km", "3522.200 km"});
    CHECK(told_apart("cycles_true", 3.0, 3.0) == Texts{"3", "3"});
    CHECK(told_apart("ratio", 0.12345678, 0.1234567) == Texts{"0.1234568", "0.1234567"});
    CHECK(told_apart("drag_mps2", 1.96 + 1e-12, 1.96).first == "1.96000000 m/s2");
}

TEST_CASE("an event's text holds its arguments, undefined ones too", "[text][R48]") {
    const auto dictionary = tests::small_dictionary();
    const Decommutator decommutator{dictionary};
    Decoded decoded;
    REQUIRE_FALSE(
        decommutator.decode(PacketFiller{dictionary, "PARACHUTE_DEPLOY"}.real("speed_mps", 404.59).seal(), decoded));
    const auto* event = event_of(dictionary, decoded);
    REQUIRE(event != nullptr);
    CHECK(event_text(dictionary, *event, decoded) == "Mortar at 404.6 m/s, {oddity}, undefined m");
}

TEST_CASE("an event names the command that it is about", "[text][R44]") {
    const auto dictionary = tests::small_dictionary();
    const Decommutator decommutator{dictionary};
    Decoded decoded;
    const auto text = [&](std::uint64_t opcode) {
        const auto packet =
            PacketFiller{dictionary, "COMMAND_REFUSED"}.raw("opcode", opcode).raw("count", 7).raw("reason", 1).seal();
        REQUIRE_FALSE(decommutator.decode(packet, decoded));
        return event_text(dictionary, *event_of(dictionary, decoded), decoded);
    };
    CHECK(text(0x0103) == "Command EDL_DO_EDL (packet 7) refused: no_parameters");
    CHECK(text(0x7777) == "Command 30583 (packet 7) refused: no_parameters");
}

TEST_CASE("a packet of channels is no event", "[text]") {
    const auto dictionary = tests::small_dictionary();
    const Decommutator decommutator{dictionary};
    Decoded decoded;
    REQUIRE_FALSE(decommutator.decode(PacketFiller{dictionary, "Status"}.seal(), decoded));
    CHECK(event_of(dictionary, decoded) == nullptr);
}

TEST_CASE("a brace that is not closed stays as it is", "[text]") {
    const auto dictionary = tests::small_dictionary();
    const Decommutator decommutator{dictionary};
    Decoded decoded;
    REQUIRE_FALSE(decommutator.decode(PacketFiller{dictionary, "PARACHUTE_DEPLOY"}.seal(), decoded));
    dictionary::Event event;
    event.format = "a {speed_mps} b {speed_mps";
    CHECK(event_text(dictionary, event, decoded) == "a 0.0 b {speed_mps");
}

TEST_CASE("every event of the shipped dictionary reads as a sentence without braces", "[text][R48]") {
    const auto& dictionary = tests::shipped_dictionary();
    const Decommutator decommutator{dictionary};
    Decoded decoded;
    CHECK(dictionary.events.size() >= 50);
    for (const auto& wanted : dictionary.events) {
        REQUIRE_FALSE(decommutator.decode(PacketFiller{dictionary, wanted.name}.seal(), decoded));
        const auto* event = event_of(dictionary, decoded);
        REQUIRE(event != nullptr);
        CHECK(event->id == wanted.id);
        const auto text = event_text(dictionary, *event, decoded);
        CHECK_FALSE(text.empty());
        INFO(text);
        CHECK(text.find('{') == std::string::npos);
    }
}

}  // namespace telemetry_text_test
