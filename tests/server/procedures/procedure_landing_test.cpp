// SPDX-License-Identifier: Apache-2.0
// Procedures carried out on a landing that is flown, by what reaches Earth and a team that does as they say.
#include "commands/encoder.hpp"
#include "server/procedures/execution.hpp"
#include "server/procedures/procedure_reader.hpp"
#include "server/rehearsal/rehearsal.hpp"
#include "server/scenario/scenario_library.hpp"
#include "telemetry/decoded_packet.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <memory>

namespace server_procedures_procedure_landing_test {

using namespace aeolis;
using namespace aeolis::server;
using namespace aeolis::server::procedures;

namespace {

std::shared_ptr<const Procedure> shipped_procedure(const std::string& name) {
    const std::vector<std::string> others{"computer_reset", "commanding_closed", "tones_lost"};
    std::ifstream file{AEOLIS_SOURCE_DIR "/dictionaries/msl/procedures/" + name + ".yaml", std::ios::binary};
    const std::string text{std::istreambuf_iterator<char>{file}, {}};
    const auto read = read_procedure(text, name + ".yaml", tests::shipped_dictionary(), others);
    REQUIRE(read.procedure);
    return std::make_shared<const Procedure>(*read.procedure);
}

simulation::Scenario shipped_scenario(const std::string& name) {
    return *ScenarioLibrary{AEOLIS_SOURCE_DIR "/simulation/scenarios"}.scenario(name);
}

/// A landing with its ground, and a procedure at a time.
class Room {
  public:
    explicit Room(const simulation::Scenario& scenario) : rehearsal_(scenario, 1, 0, tests::shipped_dictionary()) {}

    const Rehearsal& rehearsal() const { return rehearsal_; }

    /// Flies until the event was received.
    void fly_until(const char* event) {
        const auto* wanted = tests::shipped_dictionary().event(event);
        while (!rehearsal_.finished() && !facts_.events().contains(wanted->id)) hear(nullptr);
        REQUIRE(facts_.events().contains(wanted->id));
    }

    /// Flies until the station receives what happens at that time from the predicted entry.
    void fly_to(double e_s) {
        const EntryPrediction prediction{rehearsal_.scenario().entry_scet, rehearsal_.run_start(1.0).light_time_s};
        const Ert until = instant_of({e_s, EntryTime::Where::received}, prediction);
        while (!rehearsal_.finished() && rehearsal_.landing().ert_now() < until) hear(nullptr);
    }

    /// Flies until the procedure is over, at most so long; the team does what each step asks for.
    Execution carry_out(const std::string& name, double at_most_s) {
        facts_.predict({rehearsal_.scenario().entry_scet, rehearsal_.run_start(1.0).light_time_s});
        Execution execution{shipped_procedure(name), tests::shipped_dictionary(), rehearsal_.landing().ert_now(),
                            facts_};
        const std::uint64_t end = rehearsal_.cycles() + static_cast<std::uint64_t>(at_most_s * 64.0);
        while (!execution.over() && rehearsal_.cycles() < end && !rehearsal_.finished()) {
            hear(&execution);
            if (rehearsal_.cycles() % 64 == 0) act(execution);
        }
        return execution;
    }

  private:
    template <typename Fact>
    void take(const Fact& fact, Execution* execution) {
        facts_.on(fact);
        if (execution != nullptr) execution->on(fact);
    }

    void hear(Execution* execution) {
        const auto& dictionary = tests::shipped_dictionary();
        for (const auto& packet : rehearsal_.step().packets) {
            if (!telemetry::is_live_telemetry(packet.link.name)) continue;
            decoder_.decode(packet.octets, decoded_);
            if (!decoded_.refusal.empty()) continue;
            if (decoded_.event != nullptr) take(EventReceived{decoded_.event->id, packet.ert}, execution);
            const auto& fields = dictionary.packets[decoded_.content.packet].fields;
            for (std::size_t i = 0; i < fields.size(); ++i)
                if (fields[i].channel)
                    take(ChannelSample{*fields[i].channel, decoded_.content.value[i], packet.ert}, execution);
        }
        hear_stages(execution);
        if (execution != nullptr) execution->pass(rehearsal_.landing().ert_now());
    }

    /// The first way for which everything is known to hold that is asked.
    static std::size_t way_of(const StepStatus& status) {
        const auto way = std::ranges::find_if(status.choices, all_hold);
        REQUIRE(way != status.choices.end());
        return static_cast<std::size_t>(way - status.choices.begin());
    }

    /// Signs, ticks, releases, sends and takes the first way, for each step whose turn it is.
    void act(Execution& execution) {
        const auto& procedure = execution.procedure();
        for (const auto* part : {&procedure.preconditions, &procedure.body, &procedure.confirmation})
            for (const Step& step : *part) {
                const StepStatus status = *execution.step(step.id);
                if (is_over(status.state) || status.state == StepState::waiting) continue;
                if (status.state == StepState::held) {
                    done(execution, {Act::Kind::release, step.id, *step.hold});
                    continue;
                }
                for (const Position position : step.signatures)
                    if (std::ranges::find(status.signatures, position, &Signature::position) == status.signatures.end())
                        done(execution, {Act::Kind::sign, step.id, position});
                if (step.command && !status.command) send(execution, step);
                if (!step.choices.empty()) {
                    Act choose{Act::Kind::choose, step.id, step.who};
                    choose.choice = way_of(status);
                    done(execution, choose);
                }
                if (!step.command && step.choices.empty() && step.conditions.empty() && step.signatures.empty())
                    done(execution, {Act::Kind::tick, step.id, step.who});
            }
    }

    void send(Execution& execution, const Step& step) {
        v1::CommandRequest request;
        request.set_command(step.command->name);
        request.set_from_solution(step.command->from_solution);
        request.set_armed(true);
        request.set_confirmation(step.command->name);
        for (const auto& [name, value] : step.command->arguments) {
            auto& argument = *request.add_arguments();
            argument.set_name(name);
            argument.set_value(value);
        }
        const auto reply = rehearsal_.submit(request, {}, true);
        INFO(step.id << ": " << reply.reason());
        REQUIRE(reply.accepted());
        hear_stages(&execution);
        Act act{Act::Kind::sent, step.id, Position::command};
        act.command = reply.command();
        done(execution, act);
    }

    void hear_stages(Execution* execution) {
        for (const auto& stage : rehearsal_.take_stages()) {
            if (execution == nullptr) continue;
            CommandFate fate{stage.command, stage.name, stage.stage, stage.status, stage.evidence, stage.ert, {}};
            if (!stage.octets.empty())
                fate.arguments =
                    commands::decode(*tests::shipped_dictionary().command(stage.name), stage.octets).value();
            execution->on(fate);
        }
    }

    void done(Execution& execution, Act act) {
        act.person = "the team";
        act.at = rehearsal_.landing().ert_now();
        const auto taken = execution.on(act);
        INFO(act.step << ": " << (taken ? "" : taken.error().message));
        REQUIRE(taken);
    }

    Rehearsal rehearsal_;
    ReceivedFacts facts_;
    telemetry::PacketDecoder decoder_{tests::shipped_dictionary()};
    telemetry::DecodedPacket decoded_;
};

std::string states(const Execution& execution) {
    std::string text{name_of(execution.part())};
    const auto& procedure = execution.procedure();
    for (const auto* part : {&procedure.preconditions, &procedure.body, &procedure.confirmation})
        for (const Step& step : *part) {
            const StepStatus& status = *execution.step(step.id);
            text += "\n" + step.id + " " + std::string{name_of(status.state)} + " " + status.command_evidence;
            for (const auto& condition : status.conditions)
                text += "; " + std::string{name_of(condition.verdict)} + ": " + condition.evidence;
        }
    return text;
}

}  // namespace

TEST_CASE(
    "with the true light time seven procedures are carried out on one landing, each in its time, and none is late",
    "[procedures][long]") {
    auto scenario = shipped_scenario("nominal_light_time");
    scenario.start_before_entry_s = 5.0 * 3600.0;
    Room room{scenario};
    const auto carry_out = [&](const char* name, double at_most_s) {
        auto execution = room.carry_out(name, at_most_s);
        INFO(name << " " << states(execution));
        CHECK(execution.part() == Part::confirmed);
        for (const StepStatus& step : execution.steps()) {
            CHECK(step.reason.empty());
            CHECK_FALSE(step.late_since);
        }
        return execution;
    };
    carry_out("start", 4500.0);
    carry_out("second_chance_enabled", 2000.0);
    carry_out("navigation_delivery", 2000.0);
    room.fly_to(-5000.0);
    carry_out("commanding_closed", 600.0);
    room.fly_to(60.0);
    // The blackout has begun a moment ago: that UHF is back is found only when it is.
    const auto uhf = carry_out("uhf_lost", 120.0);
    CHECK(uhf.step("back")->over_since->microseconds - uhf.begun().microseconds > 30'000'000);
    room.fly_to(310.0);
    carry_out("tones_lost", 60.0);
    room.fly_until("TOUCHDOWN");
    carry_out("day_after", 120.0);
}

TEST_CASE("start and Second Chance are confirmed on a landing that is flown, by what reached Earth, with no tick "
          "against a condition",
          "[procedures][release]") {
    Room room{shipped_scenario("nominal")};
    const auto start = room.carry_out("start", 240.0);
    INFO(states(start));
    CHECK(start.part() == Part::confirmed);
    for (const char* by_itself : {"computer", "not_begun", "send_parameters", "late_cruise", "do_edl", "begun"}) {
        INFO(by_itself);
        CHECK(start.step(by_itself)->state == StepState::checked);
    }
    for (const StepStatus& step : start.steps()) CHECK(step.reason.empty());
    for (const auto& watchdog : start.watchdogs()) CHECK_FALSE(watchdog.tripped);

    const auto second = room.carry_out("second_chance_enabled", 240.0);
    INFO(states(second));
    CHECK(second.part() == Part::confirmed);
    CHECK(second.step("enable")->late_since);  // 20 minutes before entry is late for what arrives at E−47:00
    CHECK(second.step("prime")->state == StepState::checked);
    CHECK(second.step("enabled")->state == StepState::checked);
}

TEST_CASE("after a reset behind cruise-stage separation the procedure for it finds Second Chance in control, and "
          "nothing is sent",
          "[procedures][release]") {
    Room room{shipped_scenario("second_chance")};
    room.fly_until("SECOND_CHANCE_TAKES_OVER");
    const auto reset = room.carry_out("computer_reset", 120.0);
    INFO(states(reset));
    CHECK(reset.part() == Part::confirmed);
    CHECK(reset.step("stage")->chosen == 1);
    CHECK(reset.step("backup")->state == StepState::checked);
    CHECK(reset.step("prime_back")->state == StepState::not_taken);
}

}  // namespace server_procedures_procedure_landing_test
