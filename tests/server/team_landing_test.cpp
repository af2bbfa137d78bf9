// SPDX-License-Identifier: Apache-2.0
#include "server/api/rehearsal_score.hpp"
#include "server/api/score_acts.hpp"
#include "server/archive/items.hpp"
#include "server/instruction/plan_library.hpp"
#include "tests/server/instructed_run.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace server_team_landing_test {

using namespace aeolis;
using namespace aeolis::server;
using namespace aeolis::test;

namespace {

/// What was received in a landing with this plan while nobody was there; with none it is a quiet one.
ScoreFacts nobody(const char* plan) {
    InstructedRuns runs;
    REQUIRE(runs.fly_new(plan == nullptr ? std::nullopt : std::optional{shipped_plan(plan)}, {}).empty());
    auto reader = runs.reader();
    auto report = whole_report(reader, archive::RunId{1});
    REQUIRE(report);
    auto facts = score_facts(reader, std::move(*report), tests::shipped_dictionary());
    REQUIRE(facts);
    return std::move(*facts);
}

v1::Score score(const ScoreFacts& facts) {
    const instruction::PlanLibrary library{shipped_dictionary_folder, tests::shipped_dictionary()};
    return score_of(facts, tests::shipped_dictionary(), library.rubric().value());
}
std::string in_text(const v1::Score& score) {
    std::string all;
    for (const auto& fact : score.facts())
        if (fact.of() == "fault" || fact.of() == "alarm") all += fact.text() + '\n';
    for (const auto& term : score.terms()) {
        all += fmt::format("{} {:.1f} of {:.1f}\n", term.name(), term.points(), term.worth());
        for (const auto& point : term.judged())
            all += fmt::format("  {:.0f} % E{:+.0f} {}: {}\n", 100.0 * point.share(), point.e_s(), point.expected(),
                               point.evidence());
    }
    return all;
}

/// A team that acknowledges each alarm after some seconds and writes what it sees.
class Team {
  public:
    explicit Team(ScoreFacts& facts) : facts_(facts) {}

    void acknowledge_all(double after_s) {
        const auto raised = acts_of(facts_.report, facts_.alarms, {}, {}, {}, tests::shipped_dictionary()).raised.all;
        for (const auto& alarm : raised) {
            auto item = at(alarm.e_s + after_s);
            item.mutable_alarm_action()->set_alarm(alarm.name);
            item.mutable_alarm_action()->set_action(v1::AlarmAction::acknowledge);
            item.mutable_alarm_action()->set_by("Ann");
            facts_.alarms.push_back(item);
        }
        std::ranges::stable_sort(facts_.alarms, {}, [](const v1::Item& item) { return item.ert_us(); });
    }
    void write(double e_s, const char* text) {
        auto item = at(e_s);
        item.mutable_note()->set_text(text);
        item.mutable_note()->set_by("Bob");
        *facts_.report.add_notes() = item;
    }
    /// When an event or tone of this name was first received.
    double heard(const char* name) const {
        const auto acts = acts_of(facts_.report, {}, {}, facts_.heard, {}, tests::shipped_dictionary());
        const auto times = acts.heard.find(name);
        INFO(name);
        REQUIRE(times != acts.heard.end());
        return *std::ranges::min_element(times->second);
    }
    void call() {
        write(heard("EDL_BEGUN") + 10.0, "EDL has begun");
        write(heard("PARACHUTE_DEPLOY") + 10.0, "Parachute deployed");
        write(heard("TOUCHDOWN") + 10.0, "Touchdown");
    }

  private:
    v1::Item at(double e_s) const {
        const auto& run = facts_.report.run();
        v1::Item item;
        item.set_ert_us(archive::ert_of(run, Sclk{run.entry_sclk() + e_s}).microseconds);
        return item;
    }
    ScoreFacts& facts_;
};

}  // namespace

TEST_CASE("a quiet landing at which nobody is there earns the landing's own share, and one that is called earns all",
          "[score][instruction][R59]") {
    auto facts = nobody(nullptr);
    const auto alone = score(facts);
    INFO(in_text(alone));
    CHECK(alone.sum() == Approx(30.0));
    Team team{facts};
    team.acknowledge_all(10.0);
    team.call();
    INFO(in_text(score(facts)));
    CHECK(score(facts).sum() >= 90.0);
}

TEST_CASE("of a landing with faults nobody earns 40 at most, a good team 90 at least, and one command too many costs",
          "[score][instruction][R59]") {
    auto facts = nobody("station_and_pyro");
    const auto alone = score(facts);
    INFO(in_text(alone));
    CHECK(alone.sum() <= 40.0);
    Team team{facts};
    team.acknowledge_all(10.0);
    team.call();
    team.write(-240.0 + 20.0, "Both links ended at once: the station's line. Procedure UHF lost begun");
    team.write(team.heard("PYRO_CONTROLLER_SILENT") + 20.0, "Pyro controller A says nothing, B fires");
    const auto good = score(facts);
    INFO(in_text(good));
    CHECK(good.sum() >= 90.0);

    // Who acknowledges all and writes every word there is, again and again, has understood nothing.
    auto bot = nobody("station_and_pyro");
    Team mindless{bot};
    mindless.acknowledge_all(5.0);
    for (double e_s = -880.0; e_s < 420.0; e_s += 20.0)
        mindless.write(e_s,
                       "station antenna line imu radar pyro engine thruster uhf power orbiter wind reset parachute "
                       "touchdown edl begun uhf lost tones lost computer reset");
    INFO(in_text(score(bot)));
    CHECK(score(bot).sum() < 75.0);
    CHECK(in_text(score(bot)).find("diagnosis 0.0 of") != std::string::npos);
    // What is written once it is over is a look back.
    auto late = nobody("station_and_pyro");
    const auto before = score(late).sum();
    REQUIRE(late.end);
    Team afterwards{late};
    const double end_e_s = archive::sclk_at_ert(late.report.run(), *late.end).seconds - late.report.run().entry_sclk();
    afterwards.write(end_e_s, "Touchdown");
    CHECK(score(late).sum() == before);

    auto& command = *facts.report.add_commands();
    command.set_command(9);
    command.set_name("NO_OP");
    for (const auto stage : {v1::CommandStage::queued, v1::CommandStage::authorised, v1::CommandStage::executed}) {
        auto& item = *command.add_stages();
        item.set_ert_us(
            archive::ert_of(facts.report.run(), Sclk{facts.report.run().entry_sclk() - 230.0}).microseconds);
        item.mutable_command_stage()->set_stage(stage);
        item.mutable_command_stage()->set_status(v1::CommandStage::ok);
        if (stage == v1::CommandStage::authorised)
            item.mutable_command_stage()->set_evidence("no arming needed, by Cem");
    }
    CHECK(score(facts).sum() <= good.sum() - 5.0);
}

TEST_CASE("what the shipped plans inject at a time or an event shows itself in what is received",
          "[score][instruction][R59]") {
    for (const char* plan : {"left_alone", "relay_lost"}) {
        const auto facts = nobody(plan);
        const auto text = in_text(score(facts));
        INFO(plan << "\n" << text);
        std::size_t injected = 0;
        for (const auto& intervention : facts.interventions) injected += intervention.has_fault() ? 1 : 0;
        CHECK(injected == 2);
        CHECK(text.find("nothing that was received showed it") == std::string::npos);
    }
}

}  // namespace server_team_landing_test
