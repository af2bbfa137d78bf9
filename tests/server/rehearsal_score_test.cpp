// SPDX-License-Identifier: Apache-2.0
#include "server/api/rehearsal_score.hpp"

#include "server/archive/items.hpp"
#include "server/instruction/plan_library.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace server_rehearsal_score_test {

using namespace aeolis;
using namespace aeolis::test;
using server::ScoreFacts;
namespace instruction = server::instruction;

namespace {

constexpr double entry_s = 1000.0;

/// A rehearsal that ended so. SCET and SCLK meet at entry; light takes 100 s.
ScoreFacts ended(v1::Landing::Outcome outcome = v1::Landing::touchdown) {
    ScoreFacts facts;
    auto& run = *facts.report.mutable_run();
    run.set_outcome(outcome);
    run.set_entry_sclk(entry_s);
    run.set_light_time_s(100.0);
    run.mutable_clock()->set_sclk(entry_s);
    run.mutable_clock()->set_scet("2012-219T05:00:00.000");
    run.mutable_clock()->set_rate(1.0);
    return facts;
}
/// An item that was received when what was sent at `e_s` is.
v1::Item item_at(double e_s) {
    v1::Item item;
    item.set_ert_us(archive::ert_of(ended().report.run(), Sclk{entry_s + e_s}).microseconds);
    return item;
}
v1::Item limit(double e_s, v1::Alarm::Severity severity) {
    auto item = item_at(e_s);
    item.mutable_alarm()->set_channel(speed.value);
    item.mutable_alarm()->set_severity(severity);
    item.mutable_alarm()->set_sclk(entry_s + e_s);
    item.mutable_alarm()->set_limit("> 90 m/s");
    return item;
}
v1::Item acknowledged(double e_s, const char* alarm = "speed_mps") {
    auto item = item_at(e_s);
    item.mutable_alarm_action()->set_alarm(alarm);
    item.mutable_alarm_action()->set_action(v1::AlarmAction::acknowledge);
    item.mutable_alarm_action()->set_by("Ann");
    return item;
}
struct Said {
    v1::CommandStage::Stage stage;
    v1::CommandStage::Status status;
    const char* evidence = "";
};
void add_command(ScoreFacts& facts, double e_s, const std::vector<Said>& stages) {
    auto& command = *facts.report.add_commands();
    command.set_command(static_cast<std::uint64_t>(facts.report.commands_size()));
    command.set_name("NO_OP");
    for (const auto& said : stages) {
        auto& item = *command.add_stages();
        item = item_at(e_s);
        item.mutable_command_stage()->set_stage(said.stage);
        item.mutable_command_stage()->set_status(said.status);
        item.mutable_command_stage()->set_evidence(said.evidence);
    }
}
using instruction::Expectation;
using instruction::Rubric;
using instruction::Skill;

/// Half of 100 points are the landing's, ten each skill's. A radar's fault shows by the speed.
Rubric rubric() {
    Rubric rubric;
    rubric.title = "of a test";
    rubric.landing_worth = 50.0;
    rubric.worth.fill(10.0);
    rubric.alarm_within_s = 30.0;
    rubric.alarm_until_s = 300.0;
    rubric.present_s = 600.0;
    auto& radar = rubric.faults.emplace_back();
    radar.kind = v1::FaultInjection::kDeviceFault;
    radar.handling.signs = {"speed_mps"};
    radar.handling.team = {{Skill::detection, Expectation::Act::acknowledge, {"speed_mps"}, 20.0},
                           {Skill::diagnosis, Expectation::Act::note, {"radar"}, 60.0},
                           {Skill::action, Expectation::Act::no_command, {}, 60.0}};
    auto& station = rubric.faults.emplace_back();
    station.kind = v1::FaultInjection::kStationOutage;
    station.handling.team = {{Skill::diagnosis, Expectation::Act::note, {"station"}, 60.0}};
    return rubric;
}
v1::Score score(const ScoreFacts& facts, const Rubric& by = rubric()) {
    return server::score_of(facts, small_dictionary(), by);
}
void add_radar_fault(ScoreFacts& facts, double e_s, const char* inject = "") {
    auto& intervention = facts.interventions.emplace_back();
    intervention.set_e_s(e_s);
    intervention.set_inject(inject);
    auto& fault = *intervention.mutable_fault()->mutable_device_fault();
    fault.set_device(v1::DEVICE_RADAR);
    fault.set_unit(v1::REDUNDANT_UNIT_A);
    fault.set_kind(v1::DEVICE_FAULT_KIND_SILENT);
    fault.set_duration_s(10.0);
}
void add_note(ScoreFacts& facts, double e_s, const char* text) {
    auto note = item_at(e_s);
    note.mutable_note()->set_text(text);
    note.mutable_note()->set_by("Bob");
    *facts.report.add_notes() = note;
}
/// "acknowledges … within 20 s: 100", a line each.
std::vector<std::string> points(const v1::Score& score, std::string_view of) {
    std::vector<std::string> texts;
    for (const auto& term : score.terms())
        if (term.name() == of)
            for (const auto& point : term.judged())
                texts.push_back(
                    fmt::format("{}: {:.0f}, {}", point.expected(), 100.0 * point.share(), point.evidence()));
    return texts;
}
const v1::ScoreTerm* term(const v1::Score& score, std::string_view name) {
    for (const auto& each : score.terms())
        if (each.name() == name) return &each;
    return nullptr;
}
std::vector<std::string> texts(const v1::Score& score, std::string_view of) {
    std::vector<std::string> texts;
    for (const auto& fact : score.facts())
        if (fact.of() == of) texts.push_back(fact.text());
    return texts;
}
using Texts = std::vector<std::string>;
using Stage = v1::CommandStage;

}  // namespace

TEST_CASE("with nobody there a landing earns its own share and no more, whether or not anything was expected",
          "[score][R59]") {
    const auto bare = score(ended());
    REQUIRE(bare.terms_size() == 1);
    CHECK(bare.terms(0).name() == "landing");
    CHECK(bare.sum() == 50.0);
    CHECK(score(ended(v1::Landing::lost)).sum() == 0.0);
    auto facts = ended();
    facts.alarms = {limit(10.0, v1::Alarm::watch)};  // never acknowledged
    CHECK(score(facts).sum() == 50.0);
    CHECK(texts(score(facts), "alarm") == Texts{"speed mps > 90 m/s; never acknowledged"});
    add_radar_fault(facts, 8.0);
    CHECK(score(facts).sum() == 50.0);  // restraint, too, is of somebody
    CHECK(points(score(facts), "action") ==
          Texts{"sends no command for 60 s: 0, nothing was sent, and nothing shows that anybody was there"});
}

TEST_CASE("a team that does in time what is expected earns all, and what comes late earns less", "[score][R59]") {
    auto facts = ended();
    add_radar_fault(facts, 8.0);
    facts.alarms = {limit(10.0, v1::Alarm::watch), acknowledged(20.0)};
    add_note(facts, 30.0, "The RADAR is gone");
    const auto good = score(facts);
    CHECK(good.sum() == Approx(100.0));
    CHECK(texts(good, "fault") ==
          Texts{"radar A silent, for 10 s; 2 s later: speed_mps; first act 10 s later: Ann: acknowledge speed_mps"});
    CHECK(points(good, "detection") ==
          Texts{"acknowledges speed_mps within 20 s: 100, acknowledged 10 s later by Ann"});
    CHECK(points(good, "diagnosis") ==
          Texts{"writes of “radar” in the log within 60 s: 100, 20 s later: Bob wrote “The RADAR is gone”"});
    facts.alarms = {limit(10.0, v1::Alarm::watch), acknowledged(40.0)};  // 30 s: half-way from 20 to 40
    CHECK(score(facts).sum() == Approx(100.0 - 50.0 / 3.0 / 2.0));
    facts.alarms = {limit(10.0, v1::Alarm::watch), acknowledged(50.0)};  // twice the limit
    CHECK(score(facts).sum() == Approx(100.0 - 50.0 / 3.0));
}

TEST_CASE("acknowledging another alarm earns nothing of a fault, and a command where none is due costs its point",
          "[score][R59]") {
    auto facts = ended();
    add_radar_fault(facts, 8.0);
    auto silent = item_at(9.0);
    silent.mutable_staleness()->set_packet("Navigation");
    silent.mutable_staleness()->set_missing(true);
    facts.alarms = {silent, limit(10.0, v1::Alarm::watch), acknowledged(12.0, "Navigation")};
    CHECK(points(score(facts), "detection") ==
          Texts{"acknowledges what else it raised, all as one: 100, 1 of 1 were acknowledged",
                "acknowledges speed_mps within 20 s: 0, never acknowledged"});
    CHECK(points(score(facts), "action") ==
          Texts{"sends no command for 60 s: 100, nothing was sent; somebody was there: Ann: acknowledge Navigation"});
    add_command(facts, 40.0,
                {{Stage::queued, Stage::ok},
                 {Stage::authorised, Stage::ok, "no arming needed, by Cem"},
                 {Stage::executed, Stage::ok}});
    CHECK(points(score(facts), "action") == Texts{"sends no command for 60 s: 0, 30 s later: Cem: sent NO_OP"});
}

TEST_CASE("a line of the log serves one fault, names a cause by whole words, and names few", "[score][R59]") {
    auto by = rubric();
    for (const char* word : {"imu", "pyro", "engine", "thruster", "power"}) {
        auto& other = by.faults.emplace_back();
        other.kind = v1::FaultInjection::kSystemFault;
        other.handling.team = {{Skill::diagnosis, Expectation::Act::note, {word}, 60.0}};
    }
    const auto diagnosed = [&](const std::vector<std::pair<double, const char*>>& notes, int faults = 1) {
        auto facts = ended();
        for (int i = 0; i < faults; ++i) {
            add_radar_fault(facts, 8.0 + 2.0 * i);
            facts.alarms.push_back(limit(10.0 + 2.0 * i, v1::Alarm::watch));
            facts.alarms.push_back(acknowledged(10.5 + 2.0 * i));
            facts.alarms.push_back(limit(11.0 + 2.0 * i, v1::Alarm::none));
        }
        for (const auto& [e_s, text] : notes) add_note(facts, e_s, text);
        double sum = 0.0;
        const auto judged = score(facts, by);
        for (const auto& point : term(judged, "diagnosis")->judged()) sum += point.share();
        return sum;
    };
    CHECK(diagnosed({{20.0, "the radars are gone"}}) == 1.0);
    CHECK(diagnosed({{20.0, "radarless"}}) == 0.0);
    CHECK(diagnosed({{20.0, "Anomaly report: the radar\nwhat the screen shows"}}) == 1.0);
    CHECK(diagnosed({{20.0, "Anomaly report: cause not known\nwhat the screen shows: radar"}}) == 0.0);
    CHECK(diagnosed({{20.0, "radar"}}, 2) == 1.0);
    CHECK(diagnosed({{20.0, "radar"}, {21.0, "radar"}}, 2) == 1.0);  // said again, it says nothing new
    CHECK(diagnosed({{20.0, "radar"}, {21.0, "and the radar once more"}}, 2) == 2.0);
    CHECK(diagnosed({{20.0, "radar imu pyro engine thruster power"}}) == 0.0);
}

TEST_CASE("of a fork only what was done from the fork on is judged, and nothing that took longer than the run",
          "[score][R59]") {
    auto facts = ended();
    add_radar_fault(facts, 8.0);
    facts.alarms = {limit(10.0, v1::Alarm::watch), acknowledged(12.0)};
    facts.report.mutable_run()->mutable_forked_from()->set_run(3);
    facts.report.mutable_run()->mutable_forked_from()->set_e_s(50.0);
    CHECK(score(facts).terms_size() == 1);
    CHECK(texts(score(facts), "landing").front() == "forked from run 3: what was done before is that run's");
    facts.report.mutable_run()->clear_forked_from();
    facts.end = Ert{item_at(30.0).ert_us()};
    CHECK(points(score(facts), "diagnosis").empty());  // 60 s were not left
    CHECK(points(score(facts), "detection").size() == 1);
}

TEST_CASE("what fell into a jump of time is not judged: nobody could act; a jump before or after changes nothing",
          "[score][R59]") {
    auto facts = ended();
    add_radar_fault(facts, 8.0);
    facts.alarms = {limit(10.0, v1::Alarm::watch)};
    const auto judged = [&](double from_e_s, double to_e_s) {
        v1::Jump jump;
        jump.set_from_e_s(from_e_s);
        jump.set_to_e_s(to_e_s);
        facts.jumps = {jump};
        return score(facts);
    };
    const auto expected = points(score(facts), "diagnosis").size();
    REQUIRE(expected == 1);
    // By the vehicle's clock; what is heard then was sent a light time, 100 s, before.
    CHECK(points(judged(105.0, 200.0), "diagnosis").empty());
    CHECK(points(judged(130.0, 400.0), "diagnosis").empty());
    CHECK(points(judged(105.0, 200.0), "detection").empty());
    CHECK(points(judged(-500.0, 105.0), "diagnosis").size() == expected);
    CHECK(points(judged(240.0, 900.0), "diagnosis").size() == expected);
    // What was done in time before it is earned.
    add_note(facts, 15.0, "radar");
    CHECK(points(judged(130.0, 400.0), "diagnosis").size() == 1);
    facts.report.clear_notes();
    const auto told = judged(105.0, 200.0);
    REQUIRE(told.faults_size() == 1);
    CHECK_THAT(told.faults(0).not_judged(0), Catch::EndsWith("the rehearsal jumped ahead meanwhile"));
}

TEST_CASE("what showed nowhere is not judged, and a plan's own words come before the rubric's", "[score][R59]") {
    auto facts = ended();
    add_radar_fault(facts, 8.0, "mine");
    CHECK(points(score(facts), "diagnosis").empty());
    CHECK(texts(score(facts), "fault") == Texts{"radar A silent, for 10 s; nothing that was received showed it"});
    instruction::Inject inject;
    inject.id = "mine";
    inject.handling.signs = {"MORTAR"};
    inject.handling.team = {{Skill::action, Expectation::Act::command, {"NO_OP"}, 30.0}};
    facts.plan.emplace().injects.push_back(inject);
    auto heard = item_at(12.0);
    heard.mutable_event()->set_name("MORTAR");
    heard.mutable_event()->set_source(v1::SOURCE_RECORDED);
    facts.heard = {heard};
    CHECK(points(score(facts), "action").empty());  // only the recording has it
    facts.heard[0].mutable_event()->set_source(v1::SOURCE_REALTIME);
    CHECK(points(score(facts), "action") == Texts{"sends NO_OP within 30 s: 0, nobody did"});
    add_command(facts, 20.0,
                {{Stage::queued, Stage::ok},
                 {Stage::authorised, Stage::ok, "no arming needed, by Cem"},
                 {Stage::executed, Stage::ok}});
    const auto judged = score(facts);
    CHECK(points(judged, "action") == Texts{"sends NO_OP within 30 s: 100, 8 s later: Cem: sent NO_OP"});
    REQUIRE(term(judged, "action") != nullptr);
    CHECK(term(judged, "action")->judged(0).inject() == "mine");
    CHECK(judged.sum() == Approx(100.0));
}

TEST_CASE("each fault stands with its signs by when they were on board and received, and with the first act after them",
          "[score][R59]") {
    auto facts = ended();
    instruction::Inject inject;
    inject.id = "mine";
    inject.handling.signs = {"MORTAR", "speed_mps", "PARACHUTE"};
    inject.handling.team = {{Skill::detection, Expectation::Act::acknowledge, {"Navigation"}, 20.0},
                            {Skill::diagnosis, Expectation::Act::note, {"mortar"}, 60.0},
                            {Skill::action, Expectation::Act::no_command, {}, 500.0}};
    facts.plan.emplace().injects.push_back(inject);
    add_radar_fault(facts, 8.0, "mine");
    const auto event = [](double received_e_s, double on_board_e_s, const char* name, v1::Source source) {
        auto item = item_at(received_e_s);
        item.mutable_event()->set_name(name);
        item.mutable_event()->set_sclk(entry_s + on_board_e_s);
        item.mutable_event()->set_source(source);
        return item;
    };
    facts.heard = {event(12.0, 9.0, "MORTAR", v1::SOURCE_REALTIME),
                   event(390.0, 10.0, "PARACHUTE", v1::SOURCE_RECORDED)};
    auto begun = item_at(14.0);
    begun.mutable_procedure_act()->set_procedure("uhf_lost");
    begun.mutable_procedure_act()->set_number(1);
    begun.mutable_procedure_act()->set_by("Dan");
    facts.room = {begun};
    add_note(facts, 5.0, "before it");
    add_note(facts, 30.0, "the mortar");
    facts.end = Ert{item_at(400.0).ert_us()};
    auto told = score(facts);
    REQUIRE(told.faults_size() == 1);
    const auto& fault = told.faults(0);
    CHECK(fault.text() == "radar A silent, for 10 s");
    CHECK(fault.inject() == "mine");
    CHECK(fault.e_s() == 8.0);
    CHECK(fault.felt_e_s() == 8.0);
    REQUIRE(fault.signs_size() == 3);
    CHECK(fault.signs(0).on_board_e_s() == Approx(9.0));
    CHECK(fault.signs(0).heard_e_s() == Approx(12.0));
    CHECK_FALSE(fault.signs(1).has_heard_e_s());
    CHECK(fault.signs(2).on_board_e_s() == Approx(10.0));  // what only the recording has could have been seen
    CHECK_FALSE(fault.signs(2).has_heard_e_s());
    CHECK(fault.seen_e_s() == Approx(12.0));
    CHECK(fault.first_act().kind() == "procedure");
    CHECK(fault.first_act().by() == "Dan");
    CHECK(fault.first_act().text() == "began procedure uhf_lost 1");
    CHECK(fault.first_act().e_s() == Approx(14.0));
    CHECK(Texts{fault.not_judged().begin(), fault.not_judged().end()} ==
          Texts{"acknowledges Navigation within 20 s: no such alarm was raised by it",
                "sends no command for 500 s: the run ended before"});
    REQUIRE(told.acts_size() == 3);
    CHECK(told.acts(0).kind() == "note");
    CHECK(told.acts(0).text() == "wrote “before it”");
    facts.heard.clear();
    told = score(facts);
    CHECK_FALSE(told.faults(0).has_seen_e_s());
    CHECK_FALSE(told.faults(0).has_first_act());
    CHECK(told.faults(0).not_judged_size() == 3);
    CHECK(told.faults(0).not_judged(1) == "writes of “mortar” in the log within 60 s: no sign of it was received");
    facts.report.mutable_run()->mutable_forked_from()->set_e_s(50.0);
    CHECK(score(facts).faults(0).not_judged(0) == "all of it: it was done before the fork");
}

TEST_CASE("acts on procedures and positions are told in words, and show that somebody is there", "[score][R59]") {
    auto facts = ended();
    add_radar_fault(facts, 8.0);
    facts.alarms = {limit(10.0, v1::Alarm::watch)};
    const auto of_procedure = [](double e_s, v1::ProcedureAct::Kind kind, const char* step, const char* reason) {
        auto item = item_at(e_s);
        auto& act = *item.mutable_procedure_act();
        act.set_number(2);
        act.set_kind(kind);
        act.set_procedure("start");
        act.set_step(step);
        act.set_reason(reason);
        act.set_by("Ann");
        return item;
    };
    const auto of_position = [](double e_s, v1::PositionAct::Kind kind) {
        auto item = item_at(e_s);
        auto& act = *item.mutable_position_act();
        act.set_kind(kind);
        act.set_position("gnc");
        act.set_by("Bob");
        act.set_to("Cem");
        act.set_subject("do edl");
        return item;
    };
    using Act = v1::ProcedureAct;
    facts.room = {of_procedure(1.0, Act::begin, "", ""),      of_procedure(2.0, Act::tick, "look", "seen twice"),
                  of_procedure(3.0, Act::choose, "look", ""), of_procedure(4.0, Act::skip, "look", "no time"),
                  of_procedure(5.0, Act::hold, "", "wait"),   of_procedure(6.0, Act::release, "", ""),
                  of_position(7.0, v1::PositionAct::take),    of_position(7.5, v1::PositionAct::offer),
                  of_position(20.0, v1::PositionAct::poll),   of_position(21.0, v1::PositionAct::no_go),
                  of_position(500.0, v1::PositionAct::leave)};
    facts.end = Ert{item_at(400.0).ert_us()};
    const auto judged = score(facts);
    Texts told;
    for (const auto& act : judged.acts()) told.push_back(act.by() + " " + act.text());
    CHECK(told == Texts{"Ann began procedure start 2", "Ann ticked look of start 2: seen twice",
                        "Ann chose way 1 at look of start 2", "Ann skipped look of start 2: no time",
                        "Ann held start 2: wait", "Ann released start 2", "Bob took gnc", "Bob offered gnc to Cem",
                        "Bob called a poll: do edl", "Bob said no go as gnc"});
    CHECK(points(judged, "action") ==
          Texts{"sends no command for 60 s: 100, nothing was sent; somebody was there: Ann: began procedure start 2"});
}

TEST_CASE("each call that the shipped rubric wants in the log is one of the standard calls, and no read-back is it",
          "[score][calls][R59]") {
    const auto& dictionary = tests::shipped_dictionary();
    const instruction::PlanLibrary library{AEOLIS_SOURCE_DIR "/dictionaries/msl", dictionary};
    const auto shipped = library.rubric();
    const auto calls = library.calls();
    REQUIRE(shipped);
    REQUIRE(calls);
    CHECK(shipped->calls.size() >= 3);
    for (const auto& wanted : shipped->calls) {
        const auto share_of = [&](const std::string& text, std::uint64_t reads_back) {
            auto facts = ended();
            auto heard = item_at(12.0);
            heard.mutable_event()->set_name(wanted.after);
            heard.mutable_event()->set_source(v1::SOURCE_REALTIME);
            facts.heard = {heard};
            auto note = item_at(14.0);
            note.mutable_note()->set_text(text);
            note.mutable_note()->set_call("c");
            note.mutable_note()->set_reads_back(reads_back);
            note.mutable_note()->set_by("Bob");
            *facts.report.add_notes() = note;
            const auto judged = server::score_of(facts, dictionary, *shipped);
            REQUIRE(term(judged, "communication") != nullptr);
            return term(judged, "communication")->judged(0).share();
        };
        INFO(wanted.after);
        const auto says = std::ranges::find_if(
            calls->calls, [&](const auto& call) { return share_of("EDL communications: " + call.says, 0) == 1.0; });
        REQUIRE(says != calls->calls.end());
        CHECK(share_of("reads back “" + says->says + "”", 7) == 0.0);
    }
}

TEST_CASE("calls are judged from when what they are of was heard live, and those of what nobody heard are not",
          "[score][R59]") {
    auto by = rubric();
    by.calls = {{"MORTAR", {"parachute"}, 30.0}, {"TOUCHDOWN", {"landed"}, 30.0}};
    auto facts = ended();
    auto heard = item_at(12.0);
    heard.mutable_tone()->set_name("MORTAR");
    heard.mutable_tone()->set_tone(41);
    facts.heard = {heard};
    add_note(facts, 5.0, "the parachute will come");  // before
    CHECK(points(score(facts, by), "communication") ==
          Texts{"after mortar: writes of “parachute” in the log within 30 s: 0, nobody did"});
    add_note(facts, 20.0, "Parachute!");
    CHECK(points(score(facts, by), "communication") ==
          Texts{"after mortar: writes of “parachute” in the log within 30 s: 100, 8 s later: Bob wrote “Parachute!”"});
}

TEST_CASE("an alarm counts to its first acknowledgement: growing worse is not another one, coming again is",
          "[score]") {
    auto facts = ended();
    facts.alarms = {limit(10.0, v1::Alarm::watch),
                    limit(12.0, v1::Alarm::distress),
                    acknowledged(25.0),
                    acknowledged(40.0),
                    limit(50.0, v1::Alarm::none),
                    limit(60.0, v1::Alarm::watch),
                    limit(61.0, v1::Alarm::none)};
    CHECK(texts(score(facts), "alarm") ==
          Texts{"speed mps > 90 m/s; acknowledged 15 s later by Ann", "speed mps > 90 m/s; never acknowledged"});
    // One that nobody has looked at and that comes again is the same one still.
    facts.alarms = {limit(10.0, v1::Alarm::watch), limit(11.0, v1::Alarm::none), limit(20.0, v1::Alarm::watch),
                    acknowledged(30.0)};
    CHECK(texts(score(facts), "alarm") == Texts{"speed mps > 90 m/s; acknowledged 20 s later by Ann"});
    auto silent = item_at(5.0);
    silent.mutable_staleness()->set_packet("Navigation");
    silent.mutable_staleness()->set_missing(true);
    facts.alarms = {silent, acknowledged(8.0, "Navigation")};
    CHECK(texts(score(facts), "alarm") == Texts{"navigation silent; acknowledged 3 s later by Ann"});
}

TEST_CASE("an outage of the station is felt at once, not a light time later", "[score]") {
    auto facts = ended();
    auto& intervention = facts.interventions.emplace_back();
    intervention.set_e_s(110.0);
    intervention.mutable_fault()->mutable_station_outage()->set_duration_s(20.0);
    facts.alarms = {acknowledged(15.0)};
    CHECK(texts(score(facts), "fault") ==
          Texts{"the ground station brings nothing, for 20 s; first act 5 s later: Ann: acknowledge speed_mps"});
}

TEST_CASE("a command of a person that failed costs a point of action, never one that was cancelled or the script's",
          "[score]") {
    auto facts = ended();
    const Said done{Stage::executed, Stage::ok};
    add_command(facts, 1.0,
                {{Stage::queued, Stage::ok, "asked for by the scenario's script, accepted as command 1"},
                 {Stage::authorised, Stage::ok, "armed and confirmed by name"},
                 done});
    add_command(facts, 2.0,
                {{Stage::queued, Stage::ok, "accepted as command 2"},
                 {Stage::authorised, Stage::ok, "armed and confirmed by name, by Ann; left to flight: x == 1"},
                 {Stage::executed, Stage::pending},
                 done});
    add_command(facts, 3.0, {{Stage::queued, Stage::failed, "asked for by the scenario's script, refused: late"}});
    add_command(facts, 3.5, {{Stage::queued, Stage::ok}, {Stage::authorised, Stage::ok, "no arming needed"}, done});
    add_command(facts, 4.0,
                {{Stage::queued, Stage::ok},
                 {Stage::authorised, Stage::ok, "no arming needed, by Bob"},
                 {Stage::executed, Stage::failed, "no answer"}});
    add_command(facts, 5.0,
                {{Stage::authorised, Stage::ok, "no arming needed, by Cem"},
                 {Stage::released, Stage::failed, "cancelled by Bob"}});
    const auto judged = score(facts);
    CHECK(texts(judged, "commands") ==
          Texts{"4 commands of people: 2 carried out, 1 failed, 1 cancelled, 0 not known",
                "2 commands of the scenario's script: 1 carried out, 1 failed, 0 cancelled, 0 not known"});
    CHECK(texts(judged, "command") == Texts{"3 NO_OP: asked for by the scenario's script, refused: late",
                                            "5 NO_OP, by Bob: no answer", "6 NO_OP, by Cem: cancelled by Bob"});
    CHECK(points(judged, "action") == Texts{"sends NO_OP so that it is carried out: 0, no answer"});
}

TEST_CASE("the score says where the landing was, which timepoints are not known, and its rule", "[score]") {
    auto facts = ended();
    facts.landed = ScoreFacts::Landed{431.0, "Touchdown: descending 0.7 m/s", 4663.0};
    facts.report.add_timepoints()->set_name("coolant_vent");
    facts.report.mutable_timepoints(0)->set_tone_e_s(-826.0);
    facts.report.add_timepoints()->set_name("cut_cables");
    const auto judged = score(facts);
    CHECK(texts(judged, "landing") == Texts{"touchdown", "Touchdown: descending 0.7 m/s",
                                            "4.7 km from the target, by the vehicle's own navigation"});
    CHECK(judged.facts(0).e_s() == 431.0);
    CHECK(texts(judged, "timepoints") == Texts{"1 of 2 are known to have fired; not: cut cables"});
    CHECK_THAT(judged.rule(),
               Catch::Contains("rubric “of a test”") && Catch::Contains("within 30 s and not at all after 300 s"));
}

}  // namespace server_rehearsal_score_test
