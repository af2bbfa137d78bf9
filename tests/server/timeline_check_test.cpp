// SPDX-License-Identifier: Apache-2.0
#include "commands/encoder.hpp"
#include "dictionaries/analysis/timeline_analysis.hpp"
#include "server/rehearsal/scripted_landing.hpp"
#include "server/rehearsal/timeline_check.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace server_timeline_check_test {

using namespace aeolis;
using namespace aeolis::server;

namespace {

double row_of(const char* name) {
    const auto& timeline = tests::shipped_dictionary().timeline;
    return static_cast<double>(std::ranges::find(timeline, name, &dictionary::TimelineRow::name) - timeline.begin());
}

v1::CommandRequest change(const char* timepoint, double desired_s, double minimum_s) {
    v1::CommandRequest request;
    request.set_command("EDL_SET_TIMEPOINT_OFFSET");
    const auto add = [&](const char* name, double value) {
        auto& argument = *request.add_arguments();
        argument.set_name(name);
        argument.set_value(value);
    };
    add("timepoint", row_of(timepoint));
    add("desired_offset_s", desired_s);
    add("minimum_offset_s", minimum_s);
    return request;
}

/// The mission's, with the one constraint that these changes are about: the analysis of all takes a second each.
const dictionary::Dictionary& one_constraint() {
    static const auto words = [] {
        auto copy = tests::shipped_dictionary();
        std::erase_if(copy.constraints, [&](const dictionary::ConstraintRow& row) {
            const bool about = moment_text(copy, row.from).starts_with("cruise_stage_separation") &&
                               moment_text(copy, row.to).starts_with("detumble");
            return row.kind == dictionary::ConstraintRow::Kind::required && !about;
        });
        return copy;
    }();
    return words;
}

const TimelineCheck::Stop never = [] { return false; };
const TimelineCheck::Stop at_once = [] { return true; };

struct Stage {
    v1::CommandStage::Stage stage;
    v1::CommandStage::Status status;
};

/// As the archive has a command with these stages.
void add(v1::CommandList& list, const v1::CommandRequest& request, std::initializer_list<Stage> stages) {
    std::vector<commands::NamedValue> arguments;
    for (const auto& argument : request.arguments()) arguments.push_back({argument.name(), argument.value()});
    const auto packet = commands::encode(*tests::shipped_dictionary().command(request.command()), arguments, 0);
    REQUIRE(packet);
    auto& command = *list.add_commands();
    command.set_command(static_cast<std::uint64_t>(list.commands_size()));
    command.set_name(request.command());
    for (const auto octet : *packet) *command.mutable_octets() += fmt::format("{:02x}", octet);
    for (const auto& [stage, status] : stages) {
        auto& item = *command.add_stages();
        item.set_seq(command.command() * 10 + static_cast<std::uint64_t>(command.stages_size()));
        item.mutable_command_stage()->set_stage(stage);
        item.mutable_command_stage()->set_status(status);
    }
}

// The cruise stage may go so late only when the plumes of the detumble come later, too (constraints.csv).
v1::CommandRequest later_detumble() {
    return change("detumble", -516.0, 0.0);
}
v1::CommandRequest later_separation() {
    return change("cruise_stage_separation", 6.046875, 2.0);
}

}  // namespace

TEST_CASE("a change is analysed on top of what left and what waits, and a failed one is not there", "[gateway][R19]") {
    TimelineCheck check{one_constraint()};
    const std::vector asked{later_separation()};
    v1::CommandList none, waits, left, cancelled;
    add(waits, later_detumble(), {{v1::CommandStage::released, v1::CommandStage::pending}});
    add(left, later_detumble(),
        {{v1::CommandStage::released, v1::CommandStage::pending}, {v1::CommandStage::released, v1::CommandStage::ok}});
    add(cancelled, later_detumble(),
        {{v1::CommandStage::released, v1::CommandStage::pending},
         {v1::CommandStage::released, v1::CommandStage::failed}});
    CHECK_FALSE(check.check(none, asked, false, never));
    CHECK(check.check(waits, asked, false, never));
    CHECK(check.check(left, asked, false, never));
    const auto without = check.check(cancelled, asked, false, never);
    REQUIRE_FALSE(without);
    CHECK_THAT(without.error().message, Catch::Contains("cruise_stage_separation") && Catch::Contains("detumble"));
    CHECK_FALSE(without.error().internal);
}

TEST_CASE("of two changes of one offset the one that leaves last stands, not the one that was asked for last",
          "[gateway][R19]") {
    TimelineCheck check{one_constraint()};
    v1::CommandList list;
    add(list, later_detumble(), {{v1::CommandStage::released, v1::CommandStage::pending}});
    add(list, change("detumble", -519.40625, 0.0),
        {{v1::CommandStage::released, v1::CommandStage::ok}});  // as it was, and sent before the one that waits
    CHECK(check.check(list, std::vector{later_separation()}, false, never));  // what waits goes after what has left
    list.mutable_commands(0)->mutable_stages(0)->mutable_command_stage()->set_status(v1::CommandStage::ok);
    list.mutable_commands(0)->mutable_stages(0)->set_seq(5);  // it left first
    CHECK_FALSE(check.check(list, std::vector{later_separation()}, false, never));
}

TEST_CASE("what still waits is looked at again with what remains", "[gateway][R19]") {
    TimelineCheck check{one_constraint()};
    v1::CommandList list;
    add(list, later_detumble(), {{v1::CommandStage::released, v1::CommandStage::pending}});
    add(list, later_separation(), {{v1::CommandStage::released, v1::CommandStage::pending}});
    auto reanalysis = check.reanalyse(list, never);
    REQUIRE(reanalysis.known.size() == 2);
    CHECK_FALSE((reanalysis.known[0].refuted || reanalysis.known[1].refuted));
    CHECK_THAT(reanalysis.known[1].words, Catch::Contains("bounds of constraints.csv hold"));

    list.mutable_commands(0)->mutable_stages(0)->mutable_command_stage()->set_status(
        v1::CommandStage::failed);  // cancelled
    reanalysis = check.reanalyse(list, never);
    REQUIRE(reanalysis.known.size() == 1);
    CHECK(reanalysis.known[0].number == 2);
    CHECK(reanalysis.known[0].refuted);
    CHECK_THAT(reanalysis.known[0].words, Catch::Contains("breaks a constraint"));
    CHECK(reanalysis.not_known.empty());
    CHECK(reanalysis.undone == 1);
}

TEST_CASE("a scenario's script is analysed as commands by hand are, each change after those sent before it",
          "[gateway][R19][R51]") {
    const auto scripted = [](double send_before_entry_s, const v1::CommandRequest& request) {
        simulation::ScriptedCommand command{send_before_entry_s, request.command(), {}, false};
        for (const auto& argument : request.arguments())
            command.arguments.emplace_back(argument.name(), argument.value());
        return command;
    };
    simulation::Scenario scenario;
    scenario.commands = {
        scripted(900.0, later_separation()), scripted(950.0, later_detumble()), {1000.0, "NO_OP", {}, false}};
    auto script = script_of(scenario, one_constraint());
    REQUIRE(script.size() == 3);
    CHECK(script.front().request.command == "NO_OP");
    for (const auto& each : script) CHECK(each.refused.empty());

    std::swap(scenario.commands[0].send_before_entry_s, scenario.commands[1].send_before_entry_s);
    script = script_of(scenario, one_constraint());
    CHECK_THAT(script[1].refused, Catch::Contains("breaks a constraint: cruise_stage_separation"));
    CHECK(script[2].refused.empty());
}

TEST_CASE("an analysis that does not end in its time is no answer, and nothing is said of what waits",
          "[gateway][R19]") {
    TimelineCheck check{one_constraint()};
    const auto answer = check.check({}, std::vector{later_detumble()}, false, at_once);
    REQUIRE_FALSE(answer);
    CHECK(answer.error().internal);
    CHECK_THAT(answer.error().message, Catch::Contains("did not end in its time"));
    v1::CommandList list;
    add(list, later_detumble(), {{v1::CommandStage::released, v1::CommandStage::pending}});
    const auto reanalysis = check.reanalyse(list, at_once);
    CHECK(reanalysis.known.empty());
    CHECK_THAT(reanalysis.not_known, Catch::Contains("did not end"));
    CHECK(check.reanalyse(list, never).known.size() == 1);  // asked again it is found
}

}  // namespace server_timeline_check_test
