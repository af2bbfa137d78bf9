// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/execution.hpp"

#include "commands/encoder.hpp"
#include "tests/server/procedures/written_procedure.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <random>

namespace server_procedures_execution_test {

using namespace aeolis;
using namespace aeolis::server::procedures;
using commands::Stage;
using commands::Status;
using tests::WrittenProcedure;

namespace {

constexpr Ert at(double seconds) {
    return {static_cast<std::int64_t>(seconds * 1.0e6)};
}

/// A procedure under way, begun at 100 s.
class UnderWay {
  public:
    explicit UnderWay(const WrittenProcedure& written)
        : execution{tests::shared_procedure(written), tests::shipped_dictionary(), at(now_s)} {}

    void hear(const char* channel, std::optional<double> value) {
        execution.on(ChannelSample{tests::shipped_dictionary().channel(channel)->id, value, at(now_s)});
    }
    void hear(const char* event) {
        execution.on(EventReceived{tests::shipped_dictionary().event(event)->id, at(now_s)});
    }
    void pass(double seconds) { execution.pass(at(now_s += seconds)); }
    void fate(std::uint64_t command, Stage stage, Status status, const char* name = "NO_OP",
              std::vector<commands::NamedValue> arguments = {}) {
        execution.on(CommandFate{command, name, stage, status, "evidence", at(now_s), std::move(arguments)});
    }
    /// Why the act was refused; empty: it was not.
    std::string act(Act::Kind kind, const std::string& step, Position position = Position::gnc,
                    const std::string& reason = "", std::size_t choice = 0, std::uint64_t command = 0) {
        const auto done = execution.on(Act{kind, step, position, "A. Ng", reason, choice, command, at(now_s)});
        return done ? "" : done.error().message;
    }
    StepState state(const char* step) const { return execution.step(step)->state; }
    const StepStatus& status(const char* step) const { return *execution.step(step); }

    double now_s = 100.0;
    Execution execution;
};

WrittenProcedure with_body(const std::string& steps) {
    WrittenProcedure written;
    written.body = "body:\n" + steps;
    return written;
}

constexpr auto director = Position::flight_director;
const std::string checked_step =
    "  - {step: a, who: gnc, do: A, check: [{channel: edl_enabled, is: '==', value: true}]}\n";

}  // namespace

TEST_CASE("a step with conditions checks itself with its evidence, and stays checked", "[procedures]") {
    UnderWay run{with_body(checked_step)};
    CHECK(run.execution.part() == Part::body);
    CHECK(run.state("a") == StepState::active);
    CHECK(run.status("a").conditions.at(0).verdict == Verdict::not_known);
    run.hear("edl_enabled", 0.0);
    CHECK(run.state("a") == StepState::active);
    CHECK(run.status("a").conditions.at(0).verdict == Verdict::does_not_hold);
    run.pass(1.0);
    run.hear("edl_enabled", 1.0);
    CHECK(run.state("a") == StepState::checked);
    CHECK(run.status("a").by.empty());
    CHECK(run.status("a").over_since == at(101.0));
    run.hear("edl_enabled", 0.0);
    CHECK(run.state("a") == StepState::checked);
    CHECK(run.status("a").conditions.at(0).evidence == "edl_enabled is true, received 2000-001T12:01:41.000");
    CHECK(run.execution.part() == Part::confirmation);
}

TEST_CASE("preconditions stand all at once and in no order; the main body begins once each is over", "[procedures]") {
    WrittenProcedure written;
    written.preconditions = "preconditions:\n  - {step: p, who: gnc, do: P}\n  - {step: q, who: systems, do: Q}\n";
    UnderWay run{written};
    CHECK(run.state("p") == StepState::active);
    CHECK(run.state("a") == StepState::waiting);
    CHECK(run.act(Act::Kind::tick, "q", Position::systems).empty());
    CHECK(run.state("a") == StepState::waiting);
    CHECK(run.act(Act::Kind::tick, "p").empty());
    CHECK(run.state("a") == StepState::active);
    CHECK(run.act(Act::Kind::tick, "a").empty());
    CHECK(run.state("z") == StepState::active);
    CHECK(run.act(Act::Kind::tick, "z").empty());
    CHECK(run.execution.part() == Part::confirmed);
    CHECK(run.act(Act::Kind::tick, "z") == "the procedure is over: confirmed");
}

TEST_CASE("a tick belongs to the step's position or the flight director, and against the conditions needs a reason",
          "[procedures]") {
    UnderWay run{with_body(checked_step)};
    CHECK(run.act(Act::Kind::tick, "a", Position::systems) == "step a is ticked by gnc or the flight director");
    CHECK(run.act(Act::Kind::tick, "b") == "'b' is no step of p");
    CHECK(run.act(Act::Kind::tick, "z") == "step z is waiting, not active");
    CHECK(run.act(Act::Kind::tick, "a") == "step a: its condition not known (edl_enabled was never received); to tick "
                                           "it all the same needs a reason");
    CHECK(run.act(Act::Kind::tick, "a", director, "seen by tones").empty());
    CHECK(run.state("a") == StepState::ticked);
    CHECK(run.status("a").by == "A. Ng (flight_director)");
    CHECK(run.status("a").reason == "seen by tones");
}

TEST_CASE("signatures are of the positions asked for, each once, and end a step that asks for nothing else",
          "[procedures]") {
    UnderWay run{with_body("  - {step: a, who: gnc, do: A, sign: [gnc, systems]}\n")};
    CHECK(run.act(Act::Kind::sign, "a", Position::navigation) == "step a needs no signature of navigation");
    CHECK(run.act(Act::Kind::sign, "a", Position::gnc).empty());
    CHECK(run.act(Act::Kind::sign, "a", Position::gnc) == "step a is already signed by gnc");
    CHECK(run.state("a") == StepState::active);
    CHECK(run.act(Act::Kind::sign, "a", Position::systems).empty());
    CHECK(run.state("a") == StepState::ticked);
    CHECK(run.status("a").signatures.size() == 2);
}

TEST_CASE("a command's step is done by the stage of the command that was sent, never by a tick", "[procedures]") {
    UnderWay run{with_body("  - {step: a, who: command, do: A, command: {name: NO_OP}}\n")};
    const auto send = [&](std::uint64_t number, Position position = Position::command) {
        return run.act(Act::Kind::sent, "a", position, "", 0, number);
    };
    CHECK(run.act(Act::Kind::tick, "a", director, "surely") == "step a is done by its command, which nobody ticks");
    CHECK(send(7, director) == "only the position command sends");
    CHECK(send(0) == "a command that was sent has a number");
    CHECK(send(7) == "no command of the number 7 was sent since this procedure was begun");
    run.fate(8, Stage::executed, Status::ok, "EDL_DO_EDL");
    CHECK(send(8) == "no command of the number 8 was sent since this procedure was begun");  // it was sent before
    run.fate(8, Stage::queued, Status::ok, "EDL_DO_EDL");
    CHECK(send(8) == "command 8 is EDL_DO_EDL, and step a has NO_OP");
    run.fate(7, Stage::queued, Status::ok);
    run.fate(9, Stage::queued, Status::ok);
    run.fate(10, Stage::queued, Status::ok);
    CHECK(send(7).empty());
    CHECK(run.status("a").command_evidence == "queued ok: evidence");
    CHECK(send(9) == "step a: its command was sent as number 7, and has not failed");
    run.fate(7, Stage::accepted, Status::ok);
    CHECK(run.state("a") == StepState::active);
    run.fate(7, Stage::executed, Status::unknown);
    CHECK(run.state("a") == StepState::active);
    CHECK(run.status("a").command_evidence == "executed unknown: evidence");
    CHECK(send(9) == "step a: of its command, number 7, something is not known; to send it again needs a reason");
    CHECK(run.act(Act::Kind::sent, "a", Position::command, "silence since then", 0, 10).empty());
    CHECK(run.status("a").reason == "silence since then");
    run.fate(7, Stage::executed, Status::ok);
    CHECK(run.state("a") == StepState::active);  // it is that of the step no longer
    run.fate(10, Stage::executed, Status::failed);
    CHECK(send(9).empty());
    run.fate(9, Stage::executed, Status::ok);
    CHECK(run.state("a") == StepState::checked);
    CHECK(run.status("a").command == 9);
}

TEST_CASE("a command with other arguments than the step's is not taken for it without a reason", "[procedures]") {
    UnderWay run{with_body("  - {step: a, who: command, do: A, command: {name: SECOND_CHANCE_ENABLE, "
                           "arguments: {enabled: \"yes\"}}}\n"
                           "  - {step: b, who: command, do: B, command: {name: EDL_SET_TIMEPOINT_OFFSET, "
                           "arguments: {desired_offset_s: 0.25}, to_fill: [timepoint]}}\n")};
    const auto send = [&](const char* step, std::uint64_t number, const std::string& reason = "") {
        return run.act(Act::Kind::sent, step, Position::command, reason, 0, number);
    };
    run.fate(1, Stage::queued, Status::ok, "SECOND_CHANCE_ENABLE", {{"enabled", 0.0}});
    run.fate(1, Stage::executed, Status::ok, "SECOND_CHANCE_ENABLE");
    CHECK(send("a", 1) == "command 1 has enabled=0 where enabled=1 is prepared; to take it for that of step a needs a "
                          "reason");
    run.fate(5, Stage::queued, Status::ok, "SECOND_CHANCE_ENABLE");
    CHECK_THAT(send("a", 5), Catch::StartsWith("command 5 has no known enabled where enabled=1 is prepared"));
    run.fate(2, Stage::queued, Status::ok, "SECOND_CHANCE_ENABLE", {{"enabled", 1.0}});
    CHECK(send("a", 2).empty());
    run.fate(2, Stage::executed, Status::ok, "SECOND_CHANCE_ENABLE");
    REQUIRE(run.state("a") == StepState::checked);

    // What is to be filled may be anything; what is neither given nor filled has its default.
    const auto& command = *tests::shipped_dictionary().command("EDL_SET_TIMEPOINT_OFFSET");
    const auto sent = [&](std::uint64_t number, std::vector<commands::NamedValue> given) {
        const auto packet = commands::encode(command, given, 0);
        REQUIRE(packet.ok());
        run.fate(number, Stage::queued, Status::ok, "EDL_SET_TIMEPOINT_OFFSET",
                 commands::decode(command, *packet).value());
    };
    sent(3, {{"timepoint", 3.0}, {"desired_offset_s", 0.5}, {"minimum_offset_s", 0.0}});
    CHECK_THAT(send("b", 3), Catch::StartsWith("command 3 has desired_offset_s=0.5 where desired_offset_s=0.25 is"));
    sent(4, {{"timepoint", 4.0}, {"desired_offset_s", 0.25}, {"minimum_offset_s", 0.0}});
    CHECK(send("b", 4).empty());
    CHECK(run.status("b").command == 4);
}

TEST_CASE("somebody chooses a branch, which leads on by its way alone", "[procedures]") {
    const auto branch =
        with_body("  - {step: a, who: gnc, do: A, choose: [{when: x, go_to: c, check: [{channel: "
                  "edl_enabled, is: '==', value: true}]}, {when: y, go_to: b}, {when: n, go_to: end}]}\n"
                  "  - {step: b, who: gnc, do: B, next: confirmation}\n"
                  "  - {step: c, who: gnc, do: C}\n");
    UnderWay run{branch};
    CHECK(run.act(Act::Kind::choose, "a", Position::systems) == "step a is decided by gnc or the flight director");
    CHECK(run.act(Act::Kind::choose, "a", Position::gnc, "", 3) == "step a has 3 ways, none of the number 3");
    CHECK(run.act(Act::Kind::tick, "a") == "step a is a branch: choose one of its ways");
    CHECK(run.act(Act::Kind::skip, "a", director, "x") == "step a is a branch: choose one of its ways");
    CHECK_THAT(run.act(Act::Kind::choose, "a"), Catch::StartsWith("step a: a condition of this way not known ("));
    run.hear("edl_enabled", 1.0);
    CHECK(run.state("a") == StepState::active);  // a branch does not choose itself
    CHECK(run.act(Act::Kind::choose, "a").empty());
    CHECK(run.state("b") == StepState::waiting);
    CHECK(run.state("c") == StepState::active);
    CHECK(run.act(Act::Kind::tick, "c").empty());
    CHECK(run.act(Act::Kind::tick, "z").empty());
    CHECK(run.state("b") == StepState::not_taken);
    CHECK(run.execution.part() == Part::confirmed);

    UnderWay ended{branch};
    CHECK(ended.act(Act::Kind::choose, "a", Position::gnc, "", 2).empty());
    CHECK(ended.execution.part() == Part::ended);
    CHECK(ended.state("z") == StepState::not_taken);

    UnderWay other{branch};
    CHECK(other.act(Act::Kind::choose, "a", Position::gnc, "", 1).empty());
    CHECK(other.act(Act::Kind::tick, "b").empty());
    CHECK(other.state("c") == StepState::waiting);
    CHECK(other.state("z") == StepState::active);
}

TEST_CASE("a hold before a step is released by its position, and its time limit begins then", "[procedures]") {
    UnderWay run{with_body("  - {step: a, who: gnc, do: A, hold: systems, limit_s: 10}\n")};
    CHECK(run.state("a") == StepState::held);
    CHECK(run.act(Act::Kind::tick, "a") == "step a is held, not active");
    run.pass(60.0);
    CHECK(run.act(Act::Kind::release, "a", Position::gnc) == "step a is released by systems or the flight director");
    CHECK(run.act(Act::Kind::release, "a", Position::systems).empty());
    CHECK(run.state("a") == StepState::active);
    CHECK(run.act(Act::Kind::release, "a", Position::systems) == "step a is active, not at its hold");
    run.pass(10.0);
    CHECK(run.state("a") == StepState::active);
    run.pass(0.5);
    CHECK(run.state("a") == StepState::late);
    CHECK(run.status("a").late_since == at(170.0));
    CHECK(run.act(Act::Kind::tick, "a").empty());
    CHECK(run.state("a") == StepState::ticked);
    CHECK(run.status("a").late_since == at(170.0));  // it was late, and that stays
}

TEST_CASE("a held procedure neither begins nor ends a step, and its time does not count", "[procedures]") {
    auto written = with_body("  - {step: a, who: gnc, do: A, limit_s: 10, check: [{channel: edl_enabled, is: '==', "
                             "value: true}]}\n");
    UnderWay run{written};
    CHECK(run.act(Act::Kind::hold, "", Position::systems) == "to hold a procedure needs a reason");
    CHECK(run.act(Act::Kind::release, "", director) == "the procedure is not held");
    CHECK(run.act(Act::Kind::hold, "", Position::systems, "noise").empty());
    CHECK(run.execution.held() == "A. Ng (systems): noise");
    CHECK(run.act(Act::Kind::hold, "", Position::gnc, "me too") ==
          "the procedure is held already: A. Ng (systems): noise");
    run.hear("edl_enabled", 1.0);
    CHECK(run.state("a") == StepState::held);
    CHECK(run.status("a").conditions.at(0).verdict == Verdict::holds);
    CHECK(run.act(Act::Kind::tick, "a") == "the procedure is held: A. Ng (systems): noise");
    run.pass(100.0);
    CHECK(run.act(Act::Kind::release, "", director).empty());
    CHECK(run.state("a") == StepState::active);  // what was received then is stale now
    CHECK(run.status("a").conditions.at(0).verdict == Verdict::not_known);
    run.pass(10.0);
    CHECK(run.state("a") == StepState::active);
    run.pass(0.5);
    CHECK(run.status("a").late_since == at(210.0));
}

TEST_CASE("a limit from entry is told only when entry is predicted", "[procedures]") {
    UnderWay run{with_body("  - {step: a, who: gnc, do: A, by: E-0:10 vehicle}\n")};
    run.pass(1000.0);
    CHECK(run.state("a") == StepState::active);
    run.execution.predict({{500'000'000}, 0.0});
    CHECK(run.state("a") == StepState::late);
    CHECK(run.status("a").late_since == at(490.0));
}

TEST_CASE("by when a command is to leave is kept once it was radiated, whenever its evidence comes", "[procedures]") {
    const auto written = with_body("  - {step: a, who: command, do: A, command: {name: NO_OP}, by: E-0:10 sent}\n");
    UnderWay sent{written}, late{written};
    for (UnderWay* run : {&sent, &late}) run->execution.predict({{500'000'000}, 100.0});  // it leaves by 390 s
    for (UnderWay* run : {&sent, &late}) {  // the second waits in the queue
        run->fate(1, Stage::queued, Status::ok);
        CHECK(run->act(Act::Kind::sent, "a", Position::command, "", 0, 1).empty());
    }
    sent.fate(1, Stage::radiated, Status::ok);
    for (UnderWay* run : {&sent, &late}) run->pass(400.0);
    CHECK(sent.state("a") == StepState::active);
    CHECK(late.status("a").late_since == at(390.0));
}

TEST_CASE("the flight director skips a step with a reason, and without its confirmation nothing is confirmed",
          "[procedures]") {
    UnderWay run{WrittenProcedure{}};
    CHECK(run.act(Act::Kind::skip, "a", Position::gnc, "x") == "only the flight director skips a step");
    CHECK(run.act(Act::Kind::skip, "a", director) == "to skip step a needs a reason");
    CHECK(run.act(Act::Kind::skip, "a", director, "not today").empty());
    CHECK(run.state("a") == StepState::skipped);
    CHECK(run.act(Act::Kind::skip, "z", director, "nor this").empty());
    CHECK(run.execution.part() == Part::ended);
}

TEST_CASE("a stopped procedure ends with what was done", "[procedures]") {
    UnderWay run{WrittenProcedure{}};
    CHECK(run.act(Act::Kind::stop, "", Position::gnc, "x") == "only the flight director stops a procedure");
    CHECK(run.act(Act::Kind::stop, "", director) == "to stop a procedure needs a reason");
    CHECK(run.act(Act::Kind::tick, "a").empty());
    CHECK(run.act(Act::Kind::stop, "", director, "over").empty());
    CHECK(run.execution.part() == Part::stopped);
    CHECK(run.state("a") == StepState::ticked);
    CHECK(run.state("z") == StepState::not_taken);
}

TEST_CASE("a watchdog trips once, keeps its evidence, holds the procedure, and is acknowledged by its position",
          "[procedures]") {
    WrittenProcedure written;
    written.watchdogs = "watchdogs:\n  - {watchdog: w, when: [{event: COMPUTER_STARTED, since: procedure}], who: "
                        "systems, do: W, hold: true}\n";
    UnderWay run{written};
    CHECK(run.act(Act::Kind::acknowledge, "w", Position::systems) == "watchdog w has not tripped");
    run.pass(1.0);
    run.hear("COMPUTER_STARTED");
    CHECK(run.execution.watchdogs().at(0).tripped == at(101.0));
    CHECK(run.execution.held() == "watchdog w");
    CHECK(run.state("a") == StepState::held);
    CHECK(run.act(Act::Kind::acknowledge, "w", Position::gnc) ==
          "watchdog w is acknowledged by systems or the flight director");
    CHECK(run.act(Act::Kind::acknowledge, "w", Position::systems).empty());
    CHECK(run.act(Act::Kind::acknowledge, "w", Position::systems) == "watchdog w is already acknowledged");
    CHECK(run.act(Act::Kind::release, "", Position::systems) ==
          "the procedure is released by whoever holds it, or by the flight director");
    CHECK(run.act(Act::Kind::release, "", director).empty());
    run.hear("COMPUTER_STARTED");
    CHECK(run.execution.held().empty());
    CHECK(run.execution.watchdogs().at(0).conditions.at(0).evidence ==
          "COMPUTER_STARTED received 2000-001T12:01:41.000");
}

TEST_CASE("a procedure knows from its beginning what was received before, and how old it is", "[procedures]") {
    const auto& dictionary = tests::shipped_dictionary();
    const auto procedure = tests::shared_procedure(with_body(
        "  - {step: a, who: gnc, do: A, check: [{channel: edl_enabled, is: '==', value: true}, {channel: reset_count, "
        "is: '==', value: 0}, {event: EDL_BEGUN, since: run}, {event: EDL_BEGUN, since: procedure}, {from: E-1:00 "
        "vehicle}]}\n"));
    ReceivedFacts before;
    before.on(ChannelSample{dictionary.channel("edl_enabled")->id, 0.0, at(60.0)});
    before.on(ChannelSample{dictionary.channel("edl_enabled")->id, 1.0, at(80.0)});
    before.on(ChannelSample{dictionary.channel("reset_count")->id, 0.0, at(60.0)});
    before.on(EventReceived{dictionary.event("EDL_BEGUN")->id, at(50.0)});
    before.predict({{150'000'000}, 0.0});
    const Execution execution{procedure, dictionary, at(100.0), before};
    std::vector<Verdict> verdicts;
    for (const auto& condition : execution.step("a")->conditions) verdicts.push_back(condition.verdict);
    CHECK(verdicts ==
          std::vector{Verdict::holds, Verdict::not_known, Verdict::holds, Verdict::does_not_hold, Verdict::holds});
}

TEST_CASE("names and reasons have limits", "[procedures]") {
    UnderWay run{WrittenProcedure{}};
    const auto with = [&](const std::string& person, const std::string& reason) {
        const auto done = run.execution.on(Act{Act::Kind::skip, "a", director, person, reason, 0, 0, at(100.0)});
        return done ? "" : done.error().message;
    };
    CHECK_THAT(with("", "x"), Catch::StartsWith("whoever acts gives a name"));
    CHECK_THAT(with(std::string(person_octets_max + 1, 'x'), "x"), Catch::StartsWith("whoever acts gives a name"));
    CHECK_THAT(with("x", std::string(reason_octets_max + 1, 'x')), Catch::StartsWith("a reason has"));
    CHECK(with("x", std::string(reason_octets_max, 'x')).empty());
}

namespace {

/// Anything that can come, at any time: most of it in place, some of it not.
using Input = std::function<bool(Execution&)>;

Input any_input(std::mt19937& random, const Execution& before, double& now_s) {
    const auto any = [&](std::size_t below) { return random() % below; };
    now_s += static_cast<double>(any(20)) * 0.25;
    const Ert now = at(now_s);
    switch (any(8)) {
    case 0:
    case 1: {
        const auto& dictionary = tests::shipped_dictionary();
        const bool enabled = any(2) == 0;
        const auto id = dictionary.channel(enabled ? "edl_enabled" : "reset_count")->id;
        const auto value = any(8) == 0 ? std::nullopt : std::optional{(any(4) != 0) == enabled ? 1.0 : 0.0};
        return [=](Execution& execution) { return execution.on(ChannelSample{id, value, now}), true; };
    }
    case 2: {
        const auto id = tests::shipped_dictionary().event(any(4) != 0 ? "EDL_BEGUN" : "COMPUTER_STARTED")->id;
        if (any(4) != 0) return [=](Execution& execution) { return execution.pass(now), true; };
        return [=](Execution& execution) { return execution.on(EventReceived{id, now}), true; };
    }
    case 3: {
        const CommandFate fate{1 + any(3),
                               any(2) == 0 ? "NO_OP" : "OTHER",
                               static_cast<Stage>(any(commands::stage_count)),
                               static_cast<Status>(any(4)),
                               "x",
                               now};
        return [=](Execution& execution) { return execution.on(fate), true; };
    }
    default: {
        static constexpr std::array steps{"p", "a", "b", "c", "d", "e", "z", "w", "", "nobody"};
        std::string step = steps[any(steps.size())];
        if (any(2) == 0)  // one whose turn it is
            for (const char* id : steps)
                if (const auto* status = before.step(id);
                    status != nullptr && !is_over(status->state) && status->state != StepState::waiting)
                    step = id;
        auto kind = static_cast<Act::Kind>(any(8));
        if (any(80) == 0) kind = Act::Kind::stop;
        if (kind == Act::Kind::hold && any(3) != 0) kind = Act::Kind::release;
        auto position = any(3) == 0 ? positions[any(positions.size())] : Position::flight_director;
        if (kind == Act::Kind::sign && any(2) == 0) position = Position::gnc;
        if (kind == Act::Kind::sent && any(2) == 0) position = Position::command;
        const Act act{kind, step, position, "A. Ng", any(2) == 0 ? "a reason" : "", any(3), any(4), now};
        return [=](Execution& execution) { return execution.on(act).ok(); };
    }
    }
}

WrittenProcedure with_everything() {
    auto written = with_body(
        "  - {step: a, who: flight_director, do: A, limit_s: 20, check: [{channel: edl_enabled, is: '==', value: true, "
        "for_s: 1}]}\n"
        "  - {step: b, who: flight_director, do: B, sign: [gnc], choose: [{when: x, go_to: c}, {when: y, go_to: e}, "
        "{when: n, go_to: end}]}\n"
        "  - {step: c, who: command, do: C, hold: flight_director, command: {name: NO_OP, until: accepted}}\n"
        "  - {step: d, who: flight_director, do: D, by: E-0:10 sent, next: confirmation}\n"
        "  - {step: e, who: flight_director, do: E, check: [{event: EDL_BEGUN, since: step}]}\n");
    written.preconditions = "preconditions:\n  - {step: p, who: flight_director, do: P, check: [{channel: reset_count, "
                            "is: '==', value: 0}]}\n";
    written.watchdogs = "watchdogs:\n  - {watchdog: w, when: [{event: COMPUTER_STARTED, since: procedure}], who: "
                        "systems, do: W, hold: true}\n";
    return written;
}

/// What holds of every execution at any time.
void check_rules(const Execution& execution, const Procedure& procedure) {
    const auto& steps = execution.steps();
    const std::size_t first = procedure.preconditions.size(), end = first + procedure.body.size();
    std::size_t open_in_body = 0;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const StepStatus& step = steps[i];
        const bool open = !is_over(step.state) && step.state != StepState::waiting;
        if (i >= first && i < end && open) ++open_in_body;
        REQUIRE(is_over(step.state) == step.over_since.has_value());
        if (step.state == StepState::checked) {
            REQUIRE(step.by.empty());
            REQUIRE((!step.conditions.empty() || step.command.has_value()));
            for (const auto& condition : step.conditions) REQUIRE(condition.verdict == Verdict::holds);
        }
        if (step.state == StepState::ticked) REQUIRE((!step.by.empty() || !step.signatures.empty()));
        if (step.state == StepState::skipped) REQUIRE((!step.by.empty() && !step.reason.empty()));
        if (step.state == StepState::active || step.state == StepState::late) REQUIRE(execution.held().empty());
        if (execution.over()) REQUIRE(is_over(step.state));
        if (i >= first && execution.part() == Part::preconditions) REQUIRE(step.state == StepState::waiting);
    }
    REQUIRE(open_in_body == (execution.part() == Part::body ? 1 : 0));
    if (execution.part() == Part::confirmed)
        for (std::size_t i = end; i < steps.size(); ++i)
            REQUIRE((steps[i].state == StepState::checked || steps[i].state == StepState::ticked));
}

/// Whether some position may do this now, with a reason, and with a command that was sent.
bool anybody_may(const Execution& execution, Act::Kind kind, const std::string& step, double now_s) {
    return std::ranges::any_of(positions, [&](Position position) {
        Execution tried{execution};
        tried.on(CommandFate{9, "NO_OP", Stage::queued, Status::ok, "x", at(now_s)});
        return tried.on(Act{kind, step, position, "A. Ng", "a reason", 0, 9, at(now_s)}).ok();
    });
}

/// What is offered is taken of somebody, and what is not offered of nobody.
void check_offers(const Execution& execution, const Procedure& procedure, double now_s) {
    using Kind = Act::Kind;
    const auto check = [&](const std::vector<Kind>& offered, const std::string& step,
                           std::initializer_list<Kind> kinds) {
        for (const Kind kind : kinds) {
            INFO(name_of(kind) << " of '" << step << "'");
            const bool offers = std::ranges::find(offered, kind) != offered.end();
            const auto* status = execution.step(step);
            // Ticked already, it lacks signatures: a second tick would only change who did it.
            if (kind == Kind::tick && status != nullptr && !status->by.empty()) {
                CHECK(!offers);
                continue;
            }
            REQUIRE(offers == anybody_may(execution, kind, step, now_s));
        }
    };
    check(execution.acts(), "", {Kind::hold, Kind::release, Kind::stop});
    std::size_t index = 0;
    for (const auto* part : {&procedure.preconditions, &procedure.body, &procedure.confirmation})
        for (const Step& step : *part)
            check(execution.acts_of_step(index++), step.id,
                  {Kind::tick, Kind::sign, Kind::choose, Kind::skip, Kind::sent, Kind::release});
    for (std::size_t i = 0; i < procedure.watchdogs.size(); ++i)
        check(execution.acts_of_watchdog(i), procedure.watchdogs[i].id, {Kind::acknowledge});
}

/// Anything in any order, in so many runs; each part is reached more than `least` times.
void check_any_order(int trials, std::size_t least) {
    const auto procedure = tests::shared_procedure(with_everything());
    std::mt19937 random{43};
    std::array<std::size_t, 6> ended_in{};
    for (int trial = 0; trial < trials; ++trial) {
        INFO("trial " << trial);
        double now_s = 100.0;
        Execution execution{procedure, tests::shipped_dictionary(), at(now_s)};
        execution.predict({{300'000'000}, 10.0});
        Execution again = execution;
        std::vector<Input> inputs;
        for (int i = 0; i < 120; ++i) {
            inputs.push_back(any_input(random, execution, now_s));
            const auto before = execution.steps();
            Execution passed = execution;
            passed.pass(at(now_s));
            const bool taken = inputs.back()(execution);
            check_rules(execution, *procedure);
            for (std::size_t k = 0; k < before.size(); ++k)
                if (is_over(before[k].state)) REQUIRE(execution.steps()[k] == before[k]);
            if (!taken) REQUIRE(execution.steps() == passed.steps());
            if (trial < trials / 10 && i % 10 == 0) check_offers(passed, *procedure, now_s);
        }
        for (const Input& input : inputs) input(again);
        REQUIRE(again.steps() == execution.steps());
        REQUIRE(again.watchdogs() == execution.watchdogs());
        REQUIRE(again.part() == execution.part());
        ++ended_in[static_cast<std::size_t>(execution.part())];
    }
    for (const std::size_t times : ended_in) CHECK(times > least);
}

}  // namespace

TEST_CASE("whatever comes in whatever order, the rules of an execution hold, in 1000 runs from a seed",
          "[procedures][release]") {
    check_any_order(1000, 10);
}

TEST_CASE("whatever comes in whatever order, the rules of an execution hold, in 150 runs from a seed", "[procedures]") {
    check_any_order(150, 1);
}

}  // namespace server_procedures_execution_test
