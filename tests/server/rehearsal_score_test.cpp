// SPDX-License-Identifier: Apache-2.0
#include "server/api/rehearsal_score.hpp"

#include "server/archive/items.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"

namespace server_rehearsal_score_test {

using namespace aeolis;
using namespace aeolis::test;
using server::ScoreFacts;

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
v1::Score score(const ScoreFacts& facts) {
    return server::score_of(facts, small_dictionary());
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

TEST_CASE("the score leaves out what there was nothing of, and is a share of what its terms are worth", "[score]") {
    const auto bare = score(ended());
    REQUIRE(bare.terms_size() == 1);
    CHECK(bare.terms(0).name() == "landing");
    CHECK(bare.sum() == 100.0);
    CHECK(score(ended(v1::Landing::lost)).sum() == 0.0);
    auto facts = ended();
    facts.alarms = {limit(10.0, v1::Alarm::watch)};  // never acknowledged
    CHECK(score(facts).sum() == 80.0);
    CHECK(texts(score(facts), "alarm") == Texts{"speed mps > 90 m/s; never acknowledged"});
}

TEST_CASE("a reaction counts in full within half a minute, and from five minutes on not at all", "[score]") {
    CHECK(server::promptness(0.0) == 1.0);
    CHECK(server::promptness(30.0) == 1.0);
    CHECK(server::promptness(165.0) == 0.5);
    CHECK(server::promptness(300.0) == 0.0);
    CHECK(server::promptness(900.0) == 0.0);
    CHECK(server::promptness({}) == 0.0);
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

TEST_CASE("the reaction to a fault is the first thing that people did from then on, never what they did before",
          "[score]") {
    auto facts = ended();
    auto note = item_at(100.0);
    note.mutable_note()->set_text("radar?");
    note.mutable_note()->set_by("Bob");
    *facts.report.add_notes() = note;
    add_command(facts, 5.0, {{Stage::queued, Stage::ok}, {Stage::authorised, Stage::ok, "no arming needed, by Ann"}});
    for (const double e_s : {10.0, 110.0}) {
        auto& intervention = facts.interventions.emplace_back();
        intervention.set_e_s(e_s);
        auto& fault = *intervention.mutable_fault()->mutable_device_fault();
        fault.set_device(v1::DEVICE_RADAR);
        fault.set_unit(v1::REDUNDANT_UNIT_A);
        fault.set_kind(v1::DEVICE_FAULT_KIND_SILENT);
        fault.set_duration_s(10.0);
    }
    const auto judged = score(facts);
    CHECK(texts(judged, "fault") == Texts{"radar A silent, for 10 s; 90 s later: Bob wrote “radar?”",
                                          "radar A silent, for 10 s; nobody did anything afterwards"});
    REQUIRE(term(judged, "faults") != nullptr);
    CHECK(term(judged, "faults")->points() == Approx(20.0 * server::promptness(90.0) / 2.0));
}

TEST_CASE("an outage of the station is felt at once, not a light time later", "[score]") {
    auto facts = ended();
    auto& intervention = facts.interventions.emplace_back();
    intervention.set_e_s(110.0);
    intervention.mutable_fault()->mutable_station_outage()->set_duration_s(20.0);
    facts.alarms = {acknowledged(15.0)};
    CHECK(texts(score(facts), "fault") ==
          Texts{"the ground station brings nothing, for 20 s; 5 s later: Ann: acknowledge speed_mps"});
}

TEST_CASE("the score judges commands of people that were not cancelled, and not those of the scenario's script",
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
    REQUIRE(term(judged, "commands") != nullptr);
    CHECK(term(judged, "commands")->points() == Approx(10.0 * 2.0 / 3.0));
    CHECK(term(judged, "commands")->why() == "2 of 3 of people were carried out");
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
    CHECK(term(judged, "timepoints")->points() == 10.0);
    CHECK(judged.rule().find("Within 30 s a reaction counts in full, after 300 s not at all.") != std::string::npos);
}

}  // namespace server_rehearsal_score_test
