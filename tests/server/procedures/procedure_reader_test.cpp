// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/procedure_reader.hpp"
#include "tests/server/procedures/written_procedure.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <random>

namespace server_procedures_procedure_reader_test {

using namespace aeolis;
using namespace aeolis::server::procedures;
using aeolis::tests::findings_of;
using aeolis::tests::procedure_of;
using aeolis::tests::WrittenProcedure;

namespace {

/// Findings of a main body; its first step stands in line 9.
std::string of_body(const std::string& steps) {
    WrittenProcedure written;
    written.body = "body:\n" + steps;
    return findings_of(written);
}

/// Findings of one condition, which begins in column 40 of line 9.
std::string of_condition(const std::string& condition) {
    return of_body("  - {step: a, who: gnc, do: A, check: [" + condition + "]}\n");
}

/// Findings of one command, which begins in column 45 of line 9.
std::string of_command(const std::string& command) {
    return of_body("  - {step: a, who: command, do: A, command: " + command + "}\n");
}

}  // namespace

TEST_CASE("a procedure is read with its parts, its words and what it holds ready", "[procedures]") {
    WrittenProcedure written;
    written.head += "approved:\n  - {position: flight_director, name: A. Ng, on: 2026-11-27}\n";
    written.body = R"(body:
  - step: a
    who: command
    do: Send it.
    hold: flight_director
    limit_s: 90
    by: E-47:00 sent
    command: {name: EDL_SET_PARAMETERS, arguments: {parachute_speed_mps: 410.5}, from_solution: true, until: verified}
  - step: b
    who: gnc
    do: Look.
    check:
      - {channel: GNC-0007, is: "<", value: 5e3, unit: m, for_s: 2.5}
      - {channel: edl_phase, is: ">=", value: edl_main}
      - {event: EDL_BEGUN, since: run}
      - {from: E+4:16 received}
    sign: [gnc, systems]
    choose:
      - {when: Go, go_to: confirmation}
      - {when: No go, go_to: end}
)";
    written.watchdogs = R"(watchdogs:
  - {watchdog: w, when: [{channel: fault_inhibit, is: "==", value: true}], who: systems, do: Tell., begin: other, hold: true}
)";
    written.rest =
        "redlines:\n  - {step: a, do: Send that., reason: R, by: B. Li, on: 2026-11-28, approved_by: A. Ng}\n";
    const auto procedure = procedure_of(written);
    const auto& dictionary = tests::shipped_dictionary();
    CHECK(procedure.approvals.at(0).name == "A. Ng");
    const Step& a = procedure.body.at(0);
    CHECK(a.hold == Position::flight_director);
    CHECK(a.limit_s == 90.0);
    CHECK(a.limit_e == EntryTime{-2820.0, EntryTime::Where::sent});
    REQUIRE(a.command);
    CHECK(a.command->arguments == std::vector<commands::NamedValue>{{"parachute_speed_mps", 410.5}});
    CHECK(a.command->from_solution);
    CHECK(a.command->until == commands::Stage::verified);
    CHECK(a.text == "Send it.");
    CHECK(text_now(procedure, a) == "Send that.");
    const Step& b = procedure.body.at(1);
    REQUIRE(b.conditions.size() == 4);
    const auto altitude = std::get<ChannelCondition>(b.conditions[0]);
    CHECK(altitude.channel == dictionary.channel("altitude_m")->id);
    CHECK(altitude.comparison == Comparison::less);
    CHECK(altitude.value == 5000.0);
    CHECK(altitude.for_s == 2.5);
    CHECK(std::get<ChannelCondition>(b.conditions[1]).value == 3.0);  // the number of edl_main
    CHECK(std::get<EventCondition>(b.conditions[2]).event == dictionary.event("EDL_BEGUN")->id);
    CHECK(std::get<TimeCondition>(b.conditions[3]).from == EntryTime{256.0, EntryTime::Where::received});
    CHECK(b.signatures == std::vector{Position::gnc, Position::systems});
    CHECK(b.choices.at(1).target == Target{Target::Kind::end, 0});
    CHECK(procedure.watchdogs.at(0).begin == "other");
    CHECK(procedure.watchdogs.at(0).hold);
}

TEST_CASE("a missing part, a part that the form does not have and an empty one are named", "[procedures]") {
    CHECK(findings_of("revision: 1\n") ==
          "p.yaml:1:1: a procedure lacks 'procedure'\np.yaml:1:1: a procedure lacks 'title'\n"
          "p.yaml:1:1: a procedure lacks 'purpose'\np.yaml:1:1: a procedure lacks 'begin_when'\n"
          "p.yaml:1:1: a procedure lacks 'source'\np.yaml:1:1: a procedure lacks 'preconditions'\n"
          "p.yaml:1:1: a procedure lacks 'body'\np.yaml:1:1: a procedure lacks 'watchdogs'\n"
          "p.yaml:1:1: a procedure lacks 'confirmation'\n");
    CHECK(findings_of("just words\n") ==
          "p.yaml:1:1: a procedure is a text, and must be a table of names and values\n");
    WrittenProcedure written;
    written.watchdogs = "watch_dogs: []\n";
    CHECK(findings_of(written) ==
          "p.yaml:1:1: a procedure lacks 'watchdogs'\n"
          "p.yaml:12:1: 'watch_dogs' is no part of a procedure; the nearest name is 'watchdogs'\n");
    written = {};
    written.preconditions = "preconditions:\n";
    CHECK(findings_of(written) == "p.yaml:7:15: 'preconditions' is empty\n");
    CHECK_THAT(of_body("  []\n"), Catch::Contains("p.yaml:9:3: 'body' has no step\n"));
    written = {};
    written.head = "procedure: q\ntitle: T\nrevision: 1.5\npurpose: ''\nbegin_when: B\nsource: S\n";
    CHECK(findings_of(written) == "p.yaml:1:12: procedure 'q' is in a file of another name: 'p'\n"
                                  "p.yaml:3:11: revision is no whole number\np.yaml:4:10: 'purpose' is empty\n");
}

TEST_CASE("steps: what is wrong with names, people, limits and targets is told, all in one pass", "[procedures]") {
    CHECK(of_body("  - {step: A b, who: captain, do: A, limit_s: 0, by: soon, next: q, sing: [gnc]}\n") ==
          "p.yaml:9:12: step 'A b' must be of lower-case letters, digits and underscores, 40 at most, and begin with a "
          "letter\n"
          "p.yaml:9:22: 'captain' is no position; the nearest name is 'command'\n"
          "p.yaml:9:47: limit_s is 0, and must be from 1 to 604800 s\n"
          "p.yaml:9:54: 'soon' is no time from entry such as 'E-47:00 sent', 'E+4:16 vehicle' or 'E+4:16 received'\n"
          "p.yaml:9:66: 'q' is no step of the main body, 'confirmation' or 'end'; the nearest name is 'A b'\n"
          "p.yaml:9:69: 'sing' is no part of a step; the nearest name is 'sign'\n");
    CHECK(of_body("  - {step: end, who: gnc, do: A}\n") ==
          "p.yaml:9:12: step 'end' has a meaning of its own as a target\n");
    CHECK(of_body("  - {step: z, who: gnc, do: A}\n") == "p.yaml:11:12: step 'z' is that of line 9\n");
    CHECK(of_body("  - {step: a, who: gnc, do: A, sign: [gnc, gnc]}\n") == "p.yaml:9:44: gnc signs twice\n");
    CHECK(of_body("  - {step: a, who: gnc, do: " + std::string(2001, 'x') + "}\n") ==
          "p.yaml:9:29: the text of a step has 2001 characters, more than 2000\n");
    WrittenProcedure written;
    written.confirmation = "confirmation:\n  - {step: z, who: gnc, do: Z, next: a}\n";
    CHECK_THAT(findings_of(written),
               Catch::StartsWith("p.yaml:11:32: 'next' is no part of a step outside the main body"));
    std::string many;
    for (std::size_t i = 0; i <= steps_max; ++i) many += fmt::format("  - {{step: s{}, who: gnc, do: A}}\n", i);
    CHECK(of_body(many) == "p.yaml:109:5: 'body' has 101 entries, more than 100\n");
}

TEST_CASE("a circle of branches and a step that nothing leads to are named", "[procedures]") {
    CHECK(of_body("  - {step: a, who: gnc, do: A}\n  - {step: b, who: gnc, do: B, next: a}\n") ==
          "p.yaml:10:5: steps go round in a circle: a → b → a\n");
    CHECK(of_body("  - {step: a, who: gnc, do: A, choose: [{when: x, go_to: a}, {when: y, go_to: end}]}\n") ==
          "p.yaml:9:5: steps go round in a circle: a → a\n");
    CHECK(of_body("  - {step: a, who: gnc, do: A, next: confirmation}\n  - {step: b, who: gnc, do: B}\n") ==
          "p.yaml:10:5: no way leads to step 'b'\n");
    CHECK(of_body("  - {step: a, who: gnc, do: A, choose: [{when: x, go_to: end}]}\n") ==
          "p.yaml:9:40: a branch has two ways or more\n");
    CHECK(
        of_body("  - {step: a, who: gnc, do: A, choose: [{when: x, go_to: end}, {when: x, go_to: confirmation}]}\n") ==
        "p.yaml:9:64: two ways of this branch are 'x'\n");
}

TEST_CASE("conditions: unknown channels and events, wrong units, types and ranges are told", "[procedures]") {
    CHECK(of_condition("{channel: altitud_m, is: '<', value: 1, unit: m}") ==
          "p.yaml:9:50: 'altitud_m' is no channel of the dictionary; the nearest name is 'altitude_m'\n");
    CHECK(of_condition("{event: EDL_BEGAN, since: run}") ==
          "p.yaml:9:48: 'EDL_BEGAN' is no event of the dictionary; the nearest name is 'EDL_BEGUN'\n");
    CHECK(of_condition("{event: EDL_BEGUN, since: ever}") ==
          "p.yaml:9:66: since 'ever': must be run, procedure or step\n");
    CHECK(of_condition("{channel: reset_count, is: '==', value: 1, since: noon}") ==
          "p.yaml:9:90: since 'noon': must be run, procedure or step\n");
    CHECK(of_condition("{event: EDL_BEGUN}") == "p.yaml:9:40: a condition on an event lacks 'since'\n");
    CHECK(of_condition("{channel: altitude_m, is: '<', value: 1}") ==
          "p.yaml:9:40: channel 'altitude_m' is in m; 'unit' must say so\n");
    CHECK(of_condition("{channel: altitude_m, is: '<', value: 1, unit: km}") ==
          "p.yaml:9:87: channel 'altitude_m' is in m, not in km\n");
    CHECK(of_condition("{channel: edl_enabled, is: '==', value: true, unit: m}") ==
          "p.yaml:9:92: channel 'edl_enabled' has no unit\n");
    CHECK(of_condition("{channel: altitude_m, is: '==', value: 1, unit: m}") ==
          "p.yaml:9:66: channel 'altitude_m' is a real number, compared by <, <=, > or >=\n");
    CHECK(of_condition("{channel: edl_enabled, is: '<', value: true}") ==
          "p.yaml:9:67: channel 'edl_enabled' is true or false, compared by == or !=\n");
    CHECK(of_condition("{channel: altitude_m, is: below, value: 1, unit: m}") ==
          "p.yaml:9:66: 'below' is no comparison: ==, !=, <, <=, > or >=\n");
    CHECK(of_condition("{channel: altitude_m, is: '<', value: low, unit: m}") ==
          "p.yaml:9:78: the value of channel 'altitude_m': 'low' is no number\n");
    CHECK(of_condition("{channel: altitude_m, is: '<', value: '1', unit: m}") ==
          "p.yaml:9:78: the value of channel 'altitude_m': '1' is no number\n");
    CHECK(of_condition("{channel: edl_enabled, is: '==', value: 1}") ==
          "p.yaml:9:80: the value of channel 'edl_enabled' is '1', and must be true or false\n");
    CHECK(of_condition("{channel: reset_count, is: '==', value: 1.5}") ==
          "p.yaml:9:80: the value of channel 'reset_count': 1.5 is no whole number\n");
    CHECK(of_condition("{channel: edl_phase, is: '==', value: edl_mane}") ==
          "p.yaml:9:78: the value of channel 'edl_phase': 'edl_mane' is no label of it; the nearest name is "
          "'edl_main'\n");
    CHECK(of_condition("{channel: altitude_m, is: '<', value: 1, unit: m, for_s: -1}") ==
          "p.yaml:9:97: for_s is -1, and must be from 0 to 86400 s\n");
    CHECK(
        of_condition("{from: E-47:00}") ==
        "p.yaml:9:47: 'E-47:00' is no time from entry such as 'E-47:00 sent', 'E+4:16 vehicle' or 'E+4:16 received'\n");
    CHECK(of_condition("{chanel: altitude_m}") ==
          "p.yaml:9:40: a condition names a 'channel', an 'event' or a time ('from')\n");
    CHECK(of_body("  - {step: a, who: gnc, do: A, check: []}\n") == "p.yaml:9:39: a list of conditions is empty\n");
}

TEST_CASE("commands: unknown ones, arguments that the encoder refuses and a wrong position are told", "[procedures]") {
    CHECK(of_command("{name: EDL_DO_ED}") ==
          "p.yaml:9:52: 'EDL_DO_ED' is no command of the dictionary; the nearest name is 'EDL_DO_EDL'\n");
    CHECK(of_command("{name: SECOND_CHANCE_ENABLE, arguments: {enabled: maybe}}") ==
          "p.yaml:9:95: argument 'enabled': 'maybe' is no label of it; the nearest name is 'yes'\n");
    CHECK(of_command("{name: SECOND_CHANCE_ENABLE}") ==
          "p.yaml:9:45: SECOND_CHANCE_ENABLE needs argument 'enabled': give it, or list it in 'to_fill'\n");
    CHECK(of_command("{name: SECOND_CHANCE_ENABLE, to_fill: [enabled]}").empty());
    CHECK(of_command("{name: SECOND_CHANCE_ENABLE, to_fill: [enabled], arguments: {enabled: 'yes'}}") ==
          "p.yaml:9:106: argument 'enabled' has a value here and is to be filled\n");
    CHECK(of_command("{name: SECOND_CHANCE_ENABLE, arguments: {enabeld: 'yes'}}") ==
          "p.yaml:9:45: SECOND_CHANCE_ENABLE needs argument 'enabled': give it, or list it in 'to_fill'\n"
          "p.yaml:9:86: 'enabeld' is no argument of SECOND_CHANCE_ENABLE; the nearest name is 'enabled'\n");
    CHECK_THAT(of_command("{name: EDL_SET_PARAMETERS, from_solution: true, arguments: {parachute_speed_mps: 5}}"),
               Catch::StartsWith("p.yaml:9:126: argument 'parachute_speed_mps' of EDL_SET_PARAMETERS is 5 m/s: must be "
                                 "from "));
    CHECK(of_command("{name: NO_OP, until: done}") ==
          "p.yaml:9:66: 'done' is no stage to wait for; the nearest name is 'radiated'\n");
    CHECK(of_command("{name: NO_OP, until: verified}") ==
          "p.yaml:9:66: NO_OP is not read back, so it has no stage 'verified'\n");
    CHECK(of_body("  - {step: a, who: gnc, do: A, command: {name: NO_OP}}\n") ==
          "p.yaml:9:20: a command is sent by position 'command', not by 'gnc'\n");
}

TEST_CASE("watchdogs and redlines name only what is there", "[procedures]") {
    WrittenProcedure written;
    written.watchdogs =
        "watchdogs:\n  - {watchdog: a, when: [{event: EDL_BEGUN, since: run}], who: gnc, do: W, begin: othr}\n";
    CHECK(findings_of(written) ==
          "p.yaml:13:16: watchdog 'a' is that of line 9\n"
          "p.yaml:13:83: 'othr' is no procedure beside this one; the nearest name is 'other'\n");
    written = {};
    written.rest = "redlines:\n  - {step: y, do: Y, reason: R, by: B, on: yesterday}\n";
    CHECK(findings_of(written) == "p.yaml:14:12: 'y' is no step; the nearest name is 'a'\n"
                                  "p.yaml:14:44: the day of a redline: 'yesterday' is no day such as 2012-08-05\n");
}

TEST_CASE("a hundred faults are told, then their number", "[procedures]") {
    std::string steps;
    for (int i = 0; i < 90; ++i) steps += fmt::format("  - {{step: s{}, who: nobody, do: ''}}\n", i);
    const std::string all = of_body(steps);
    CHECK(std::ranges::count(all, '\n') == 101);
    CHECK_THAT(all, Catch::EndsWith(": 80 more faults follow\n"));
}

TEST_CASE("a text spoiled anywhere is read or refused with places inside it, 3000 times from a seed", "[procedures]") {
    const auto& dictionary = tests::shipped_dictionary();
    WrittenProcedure written;
    written.body = "body:\n  - {step: a, who: command, do: A, command: {name: NO_OP}, hold: gnc, next: b}\n"
                   "  - {step: b, who: gnc, do: B, check: [{channel: altitude_m, is: '<', value: 1, unit: m}]}\n";
    const std::string whole = written.text();
    std::mt19937 random{1};
    std::size_t refused = 0;
    for (int trial = 0; trial < 3000; ++trial) {
        std::string text = whole;
        for (auto changes = 1 + random() % 3; changes > 0; --changes) {
            const auto at = random() % text.size();
            switch (random() % 4) {
            case 0: text.erase(at, 1 + random() % 20); break;
            case 1: text[at] = static_cast<char>(random() % 256); break;
            case 2: text.insert(at, text.substr(random() % text.size(), random() % 30)); break;
            default: text.insert(at, 1, "{}[]:,-\n'\"&*!|>#% "[random() % 19]); break;
            }
            if (text.empty()) text = "x";
        }
        const auto read = read_procedure(text, "p.yaml", dictionary, tests::other_procedures());
        const auto lines = static_cast<unsigned>(std::ranges::count(text, '\n')) + 1;
        INFO("trial " << trial << ": " << text);
        REQUIRE(read.procedure.has_value() == read.findings.empty());
        for (const auto& finding : read.findings) {
            REQUIRE(finding.mark.line >= 1);
            REQUIRE(finding.mark.line <= lines + 1);
            REQUIRE(finding.message.find('\n') == std::string::npos);
        }
        refused += read.procedure ? 0 : 1;
    }
    CHECK(refused > 2000);
}

}  // namespace server_procedures_procedure_reader_test
