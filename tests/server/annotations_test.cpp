// SPDX-License-Identifier: Apache-2.0
#include "server/pipeline/annotations.hpp"

#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"

namespace server_annotations_test {

using namespace aeolis;
using namespace aeolis::server;

namespace {

const std::vector<std::string> links{"uhf_live", "x_band"};

v1::AlarmRequest request(const char* channel, const char* action, double shelve_s = 0.0) {
    v1::AlarmRequest asked;
    asked.set_channel(channel);
    asked.set_action(action);
    asked.set_shelve_s(shelve_s);
    return asked;
}

std::string refusal(const v1::AlarmRequest& asked, const std::string& by = "Ada") {
    const auto record = alarm_action_of(asked, test::small_dictionary(), links, by, Ert{});
    return record ? "" : record.error().message;
}

std::string refusal_of_note(const std::string& text, const std::string& by = "Ada") {
    v1::NoteRequest asked;
    asked.set_text(text);
    const auto note = note_of(asked, by, Ert{});
    return note ? "" : note.error().message;
}

}  // namespace

TEST_CASE("an act on an alarm is kept under the channel's own name, a stale packet's under the packet's, a lost link's "
          "under the link's",
          "[alarms][http]") {
    const auto dictionary = test::small_dictionary();
    const auto by_alias =
        alarm_action_of(request("GNC-0002", "shelve", 60.0), dictionary, links, "Ada", Ert{5'000'000});
    REQUIRE(by_alias);
    CHECK(by_alias->alarm == "speed_mps");
    CHECK(by_alias->by == "Ada");
    CHECK(by_alias->until == Ert{65'000'000});
    CHECK(alarm_action_of(request("Navigation", "acknowledge"), dictionary, links, "Ada", Ert{})->alarm ==
          "Navigation");
    CHECK(alarm_action_of(request("x_band", "acknowledge"), dictionary, links, "Ada", Ert{})->alarm == "x_band");
}

TEST_CASE("an act that names nothing, nobody or no time is refused by its field", "[alarms][http]") {
    CHECK(refusal(request("moon", "acknowledge")) == "channel: there is no channel, packet or link 'moon'");
    CHECK_THAT(refusal(request("speed_mps", "forget")), Catch::StartsWith("action: 'forget'"));
    CHECK_THAT(refusal(request("speed_mps", "shelve")), Catch::StartsWith("shelve_s: 0"));
    CHECK_THAT(refusal(request("speed_mps", "shelve", 86'401.0)), Catch::StartsWith("shelve_s: 86401"));
    CHECK_THAT(refusal(request("speed_mps", "reset", 1.0)), Catch::StartsWith("shelve_s: reset"));
    CHECK_THAT(refusal(request("speed_mps", "reset"), " "), Catch::StartsWith("by: who"));
}

TEST_CASE("a note is kept as it was written, and refused when it is empty, too long or nobody's", "[notes][http]") {
    v1::NoteRequest asked;
    asked.set_text("<b>chute</b>\n'; DROP TABLE notes; --");
    asked.set_sclk(1000.5);
    const auto note = note_of(asked, "Ada", Ert{7});
    REQUIRE(note);
    CHECK(note->text == asked.text());
    CHECK(note->sclk_s == 1000.5);
    CHECK(note->ert == Ert{7});
    CHECK(refusal_of_note(std::string(note_octets_max, 'x')).empty());
    CHECK_THAT(refusal_of_note(std::string(note_octets_max + 1, 'x')), Catch::StartsWith("text: 4001 octets"));
    CHECK(refusal_of_note(" \n") == "text: the note is empty");
    CHECK_THAT(refusal_of_note("chute", ""), Catch::StartsWith("by: who"));
    CHECK_THAT(refusal_of_note("chute", std::string(101, 'x')), Catch::StartsWith("by: 101 octets"));
}

namespace {

procedures::CallList calls() {
    return {20.0, {{"parachute_seen", 'p', "Parachute seen", ""}, {"tone_heard", 't', "Tone heard", "which tone"}}};
}
v1::NoteRequest call(const char* id, const char* position = "", const char* text = "") {
    v1::NoteRequest asked;
    asked.set_call(id);
    asked.set_position(position);
    asked.set_text(text);
    return asked;
}
std::string refusal_of_call(const v1::NoteRequest& asked, const procedures::CallList& of = calls()) {
    const auto note = call_of(asked, of, "Ada", Ert{});
    return note ? "" : note.error().message;
}

}  // namespace

TEST_CASE("a standard call is a line of the log that its position says, and another line reads it back",
          "[notes][calls][R59]") {
    const auto note = call_of(call("parachute_seen", "edl_communications"), calls(), "Ada", Ert{7});
    REQUIRE(note);
    CHECK(note->text == "EDL communications: Parachute seen");
    CHECK(note->call == "parachute_seen");
    CHECK(note->position == "edl_communications");
    CHECK(note->reads_back == 0);
    CHECK(note->by == "Ada");
    CHECK(note->ert == Ert{7});
    CHECK(call_of(call("tone_heard", "gnc", "165"), calls(), "Ada", Ert{})->text == "GNC: Tone heard: 165");
    CHECK(call_of(call("parachute_seen"), calls(), "Ada", Ert{})->text == "Parachute seen");
    v1::NoteRequest wanted;
    wanted.set_reads_back(12);
    wanted.set_position("relay_and_station");
    v1::Note called;
    called.set_text(note->text);
    called.set_call(note->call);
    const auto read_back = read_back_of(wanted, called, "Bob", Ert{9});
    REQUIRE(read_back);
    CHECK(read_back->text == "Relay and station: reads back “EDL communications: Parachute seen”");
    CHECK(read_back->call == "parachute_seen");
    CHECK(read_back->position == "relay_and_station");
    CHECK(read_back->reads_back == 12);
}

TEST_CASE("a call that there is not, or that lacks what it asks for, is refused by its field", "[notes][calls][R59]") {
    CHECK(refusal_of_call(call("chute")) == "call: there is no 'chute'; calls are parachute_seen, tone_heard");
    CHECK(refusal_of_call(call("chute"), {}) == "call: the mission has no standard calls, so no 'chute'");
    CHECK(refusal_of_call(call("tone_heard", "", " ")) == "text: which tone?");
    CHECK(refusal_of_call(call("parachute_seen", "", "well")) == "text: the call parachute_seen says all by itself");
    CHECK_THAT(refusal_of_call(call("parachute_seen", "captain")),
               Catch::StartsWith("position: there is no 'captain'"));
    auto both = call("parachute_seen");
    both.set_reads_back(3);
    CHECK_THAT(refusal_of_call(both), Catch::StartsWith("reads_back: "));
    auto plain = call("", "gnc", "a note");
    CHECK_THAT(note_of(plain, "Ada", Ert{}).error().message, Catch::StartsWith("position: is for"));
    auto words = call("", "", "well");
    words.set_reads_back(3);
    CHECK_THAT(read_back_of(words, {}, "Ada", Ert{}).error().message, Catch::StartsWith("text: "));
}

}  // namespace server_annotations_test
