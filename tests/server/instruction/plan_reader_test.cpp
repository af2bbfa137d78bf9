// SPDX-License-Identifier: Apache-2.0
#include "server/instruction/plan_reader.hpp"

#include "server/instruction/plan_library.hpp"
#include "server/rehearsal/scripted_landing.hpp"
#include "server/scenario/scenario_library.hpp"
#include "server/scenario/scenario_text.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <random>

namespace server_instruction_plan_reader_test {

using namespace aeolis;
using namespace aeolis::server::instruction;

namespace {

const std::filesystem::path shipped_folder = AEOLIS_SOURCE_DIR "/dictionaries/msl";

Result<void> possible(const v1::FaultInjection& fault) {
    static const auto scenario =
        server::ScenarioLibrary{AEOLIS_SOURCE_DIR "/simulation/scenarios"}.scenario("nominal_auto").value();
    const auto checked = server::fault_from_message(fault, scenario);
    return checked ? Result<void>{} : Result<void>{checked.error()};
}

std::vector<Inject> library_of(const v1::InstructorPlan& plan) {
    auto read = read_library(plan.library(), "injects.yaml", tests::shipped_dictionary(), possible);
    REQUIRE(read.injects);
    return std::move(*read.injects);
}

const std::vector<Inject>& library() {
    static const auto injects = [] {
        v1::InstructorPlan plan;
        plan.set_library(
            "library: injects\nsource: S\ninjects:\n"
            "  - {inject: known, title: Known, fault: {station_outage_s: 30}, shows: All ends, signs: [x_band], "
            "team: [{of: action, no_command: any, within_s: 60}]}\n");
        return library_of(plan);
    }();
    return injects;
}

constexpr const char* head = "plan: p\ntitle: T\npurpose: P\nsource: S\ninjects:\n";  // lines 1 to 5

ReadPlan read(const std::string& injects) {
    return read_plan(head + injects, "p.yaml", tests::shipped_dictionary(), library(), possible);
}
/// What reading finds in injects, which begin in line 6.
std::string findings(const std::string& injects) {
    const auto plan = read(injects);
    CHECK(plan.plan.has_value() == plan.findings.empty());
    return plan.findings_text();
}
/// Findings of an inject's parts, all in line 6.
std::string of_inject(const std::string& parts) {
    return findings("  - {inject: a, title: A, " + parts + "}\n");
}

}  // namespace

TEST_CASE("a plan is read with its triggers, faults, signs and what a team does", "[instruction][R59]") {
    const auto plan = read(
        "  - inject: line\n    title: The line\n    when: [{from: \"E+1:30 vehicle\"}, {event: PARACHUTE_DEPLOY}]\n"
        "    after_s: 2\n    fault: {station_outage_s: 30}\n    shows: Nothing comes\n    signs: [x_band, IMU_SILENT]\n"
        "    team:\n      - {of: detection, acknowledge: [x_band], within_s: 20}\n"
        "      - {of: action, no_command: any, within_s: 60}\n"
        "  - {inject: power, title: P, when: by hand, fault: {device: power, unit: a, kind: late, duration_s: 4, "
        "late_s: 1}}\n");
    CHECK(plan.findings_text() == "");
    REQUIRE(plan.plan);
    const auto& [line, power] = std::tie(plan.plan->injects.at(0), plan.plan->injects.at(1));
    CHECK(when_text(line, tests::shipped_dictionary()) ==
          "from E+1:30 vehicle, and PARACHUTE_DEPLOY on board, 2 s later");
    CHECK(text_of(line.fault) == "the ground station brings nothing, for 30 s");
    CHECK(line.handling.signs == std::vector<std::string>{"x_band", "IMU_SILENT"});
    REQUIRE(line.handling.team.size() == 2);
    CHECK(text_of(line.handling.team[0]) == "acknowledges x_band within 20 s");
    CHECK(text_of(line.handling.team[1]) == "sends no command for 60 s");
    CHECK(power.when.empty());
    CHECK(text_of(power.fault) == "power A late by 1 s, for 4 s");
}

TEST_CASE("what is wrong in a plan is named with its line and column, all in one reading", "[instruction][R59]") {
    CHECK(of_inject("when: by hand") == "p.yaml:6:5: an inject lacks 'fault', or 'use' of one that has it");
    CHECK(of_inject("when: soon, fault: {computer_reset: true}") ==
          "p.yaml:6:33: 'when' is 'by hand', or a list of conditions");
    CHECK(of_inject("when: by hand, fault: {station_outage_s: -1}") ==
          "p.yaml:6:68: station_outage_s is -1, and must be from 0 to 604800 s");
    CHECK(of_inject("when: by hand, fault: {device: radio, unit: a, kind: silent, duration_s: 1}")
              .find("'radio' is no device") != std::string::npos);
    CHECK(of_inject("when: by hand, fault: {device: rover_imu, unit: b, kind: silent, duration_s: 1}")
              .find("p.yaml:6:49: ") != std::string::npos);
    CHECK(
        of_inject("when: by hand, fault: {computer_reset: true, system_fault_s: 3}").find("a fault is one of these") !=
        std::string::npos);
    CHECK(of_inject("when: by hand, after_s: 3, fault: {computer_reset: true}") ==
          "p.yaml:6:51: what is injected by hand has no 'after_s'");
    CHECK(of_inject("when: [{event: NO_SUCH}], fault: {computer_reset: true}").find("'NO_SUCH' is no event") !=
          std::string::npos);
    CHECK(of_inject("when: [{event: TOUCHDOWN, since: step}], fault: {computer_reset: true}")
              .find("'since' is no part") != std::string::npos);
    CHECK(of_inject("when: by hand, fault: {computer_reset: true}, signs: [x_band]")
              .find("'signs' stands beside a 'team'") != std::string::npos);
    const auto team = [](const std::string& expectation) {
        return of_inject("when: by hand, fault: {computer_reset: true}, team: [" + expectation + "]");
    };
    CHECK(team("{of: luck, note: any, within_s: 3}").find("'luck' is no skill") != std::string::npos);
    CHECK(team("{of: action, within_s: 3}").find("a team does one of these") != std::string::npos);
    CHECK(team("{of: action, note: any}").find("lacks 'within_s'") != std::string::npos);
    CHECK(team("{of: action, command: any, within_s: 3}").find("must be a list") != std::string::npos);
    CHECK(team("{of: action, command: [NO_SUCH], within_s: 3}").find("'NO_SUCH' is no command") != std::string::npos);
    CHECK(team("{of: detection, acknowledge: [nothing], within_s: 3}").find("'nothing' is no alarm") !=
          std::string::npos);
    CHECK(team("{of: action, command: [NO_OP], within_s: 9}, {of: action, no_command: any, within_s: 9}")
              .find("inject 'a': its team sends NO_OP within 9 s, and sends no command for 9 s") != std::string::npos);
    CHECK(findings("  - {inject: a, title: A, when: by hand, fault: {computer_reset: true}}\n"
                   "  - {inject: a, title: B, when: by hand, fault: {computer_reset: true}}\n") ==
          "p.yaml:7:14: inject 'a' is that of line 6");
    CHECK(read_plan("plan: q\ntitle: T\npurpose: P\nsource: S\ninjects: []\n", "p.yaml", tests::shipped_dictionary(),
                    {}, {})
              .findings_text() ==
          "p.yaml:1:7: plan 'q' is in a file of another name: 'p'\np.yaml:5:10: 'injects' has no inject");
    CHECK(!read_plan("", "p.yaml", tests::shipped_dictionary(), {}, {}).plan);
}

TEST_CASE("an inject of the library is used by its name, and each part that stands beside it replaces the library's",
          "[instruction][R59]") {
    const auto plan = read("  - {inject: a, use: known, when: by hand}\n"
                           "  - {inject: b, use: known, when: by hand, title: Mine, fault: {orbiter_outage_s: 40}}\n");
    INFO(plan.findings_text());
    REQUIRE(plan.plan);
    const auto& [a, b] = std::tie(plan.plan->injects.at(0), plan.plan->injects.at(1));
    CHECK((a.id == "a" && a.title == "Known" && a.shows == "All ends"));
    CHECK(text_of(a.fault) == "the ground station brings nothing, for 30 s");
    CHECK(a.handling.team.size() == 1);
    CHECK((b.id == "b" && b.title == "Mine" && b.shows == "All ends"));
    CHECK(text_of(b.fault) == "no orbiter relays, for 40 s");
    CHECK(findings("  - {inject: a, use: knwon, when: by hand}\n") ==
          "p.yaml:6:22: 'knwon' is no inject of the library; the nearest name is 'known'");
    CHECK(of_inject("when: by hand, fault: {uhf_loss: {fraction: 0.95, duration_s: 3}}")
              .find("uhf_losses[0].fraction: 0.95") != std::string::npos);
    CHECK(of_inject("when: by hand, fault: {wind_shift: {east_mps: 3, duration_s: 3}}").find("lacks 'north_mps'") !=
          std::string::npos);
    CHECK(of_inject("when: by hand, fault: {air_shift: {fraction: -0.9, duration_s: 3}}")
              .find("air_shifts[0].fraction: -0.9 is 0 or outside -0.5") != std::string::npos);
    CHECK(of_inject("when: by hand, fault: {sensor_error: {device: pyro, unit: a, off_by: 1, duration_s: 3}}")
              .find("only the IMU and the radar") != std::string::npos);
    CHECK(of_inject("when: by hand, fault: {sensor_error: {device: imu, unit: a, duration_s: 3}}")
              .find("has 'off_by' or 'grows_per_s'") != std::string::npos);
    CHECK(of_inject("when: by hand, fault: {false_tone: {tone: check_faild, duration_s: 3}}")
              .find("'check_faild' is no tone; the nearest name is 'check_failed'") != std::string::npos);
    const auto tone = read("  - {inject: a, title: A, when: by hand, fault: {false_tone: {tone: check_failed, "
                           "duration_s: 20}}}\n");
    INFO(tone.findings_text());
    REQUIRE(tone.plan);
    CHECK(text_of(tone.plan->injects.at(0).fault) == "the vehicle sends tone 1 in place of its own, for 20 s");
    const auto off = read("  - {inject: a, title: A, when: by hand, fault: {sensor_error: {device: imu, unit: b, "
                          "off_by: 0.05, grows_per_s: 0.01, duration_s: 60}}}\n"
                          "  - {inject: b, title: B, when: by hand, fault: {air_shift: {fraction: -0.1, duration_s: "
                          "600}}}\n");
    INFO(off.findings_text());
    REQUIRE(off.plan);
    CHECK(text_of(off.plan->injects.at(0).fault) ==
          "imu B measures forces wrongly by 0.05 m/s² and 0.01 m/s² more each second, for 60 s");
    CHECK(text_of(off.plan->injects.at(1).fault) == "the air is 10 % thinner, for 600 s");
    const auto of_library = [](const std::string& inject) {
        const auto read_one = read_library("library: injects\nsource: S\ninjects:\n  - " + inject + "\n",
                                           "injects.yaml", tests::shipped_dictionary(), {});
        return read_one.findings.empty() ? "" : read_one.findings.front().text();
    };
    CHECK(of_library("{inject: a, title: A, fault: {computer_reset: true}, when: by hand}").find("'when' is no part") !=
          std::string::npos);
    CHECK(of_library("{inject: a, title: A}") == "injects.yaml:4:5: an inject lacks 'fault'");
}

TEST_CASE("injects at fixed times that cannot both be are refused together", "[instruction][R59]") {
    const auto pair = [](const std::string& first, const std::string& second) {
        return findings("  - {inject: a, title: A, " + first + "}\n  - {inject: b, title: B, " + second + "}\n");
    };
    const std::string silent = "fault: {device: pyro, unit: a, kind: silent, duration_s: 60}";
    const std::string refuses = "fault: {device: pyro, unit: a, kind: refuses, duration_s: 5}";
    CHECK(pair("when: [{from: \"E+1:00 vehicle\"}], " + silent, "when: [{from: \"E+1:30 vehicle\"}], " + refuses) ==
          "p.yaml:7:5: injects 'a' and 'b' are faults of one unit at once");
    CHECK(pair("when: [{from: \"E+1:00 vehicle\"}], " + silent, "when: [{from: \"E+2:30 vehicle\"}], " + refuses)
              .empty());
    const std::string none = "fault: {station_outage_s: 5}, team: [{of: action, no_command: any, within_s: 3600}]";
    const std::string some = "fault: {computer_reset: true}, team: [{of: action, command: [NO_OP], within_s: 60}]";
    CHECK(pair("when: [{from: \"E-5:00 vehicle\"}], " + none, "when: [{from: \"E-4:00 vehicle\"}], " + some) ==
          "p.yaml:7:5: injects 'a' and 'b': of one a command is wanted while the other forbids it");
    CHECK(of_inject("when: by hand, fault: {device: pyro, unit: a, kind: silent, duration_s: 60, late_s: 3}")
              .find("'late_s' stands beside 'kind: late' only") != std::string::npos);
    CHECK(of_inject("when: by hand, fault: {computer_reset: true}, team: [{of: diagnosis, note: [e], within_s: 3}]")
              .find("'e' stands in too many words") != std::string::npos);
}

TEST_CASE("the plans and the rubric that ship break no rule, in the scenario for which each was written",
          "[instruction][R59]") {
    const PlanLibrary library{shipped_folder, tests::shipped_dictionary()};
    const server::ScenarioLibrary scenarios{AEOLIS_SOURCE_DIR "/simulation/scenarios"};
    const auto list = library.list();
    CHECK(static_cast<std::size_t>(list.plans_size()) == yaml_files_in(shipped_folder / "plans").size());
    CHECK(list.plans_size() >= 3);
    CHECK(list.library_size() >= 8);
    for (const auto& inject : list.library()) {
        INFO(inject.name());
        CHECK(possible(inject.fault()).ok());
        CHECK(inject.team_size() > 0);
    }
    for (const auto& entry : list.plans()) {
        INFO(entry.name());
        const auto scenario = scenarios.scenario(entry.scenario().empty() ? "nominal_auto" : entry.scenario());
        REQUIRE(scenario);
        const auto text = library.plan(entry.name());
        REQUIRE(text);
        CHECK(read_plan(text->text(), text->name(), tests::shipped_dictionary(), library_of(*text),
                        [&](const auto& fault) {
                            const auto checked = server::fault_from_message(fault, *scenario);
                            return checked ? Result<void>{} : Result<void>{checked.error()};
                        })
                  .findings_text()
                  .empty());
    }
    const auto rubric = library.rubric();
    REQUIRE(rubric);
    CHECK(rubric->landing_worth <= 40.0);
    const auto none = library.plan("../rubric");
    REQUIRE(!none);
    CHECK_THAT(none.error().message, Catch::StartsWith("plan '../rubric': there is none of this name; there are: "));
    CHECK(PlanLibrary{{}, tests::shipped_dictionary()}.list().plans_size() == 0);
    CHECK(!PlanLibrary{{}, tests::shipped_dictionary()}.rubric());
}

TEST_CASE("the rubric that ships says of each kind of fault what is done about it", "[instruction][R59]") {
    const auto rubric = PlanLibrary{shipped_folder, tests::shipped_dictionary()}.rubric();
    REQUIRE(rubric);
    for (int device = 1; v1::Device_IsValid(device); ++device) {
        v1::FaultInjection fault;
        fault.mutable_device_fault()->set_device(static_cast<v1::Device>(device));
        INFO(v1::Device_Name(static_cast<v1::Device>(device)));
        CHECK(!rubric->handling_of(fault).team.empty());
    }
    v1::FaultInjection reset, outage, system;
    reset.set_computer_reset(true);
    outage.mutable_station_outage();
    system.mutable_system_fault();
    for (const auto* fault : {&reset, &outage, &system}) CHECK(!rubric->handling_of(*fault).team.empty());
    CHECK(rubric->handling_of({}).team.empty());
}

TEST_CASE("a rubric whose parts are not worth 100, or whose words are unknown, is refused", "[instruction][R59]") {
    const auto of = [](const std::string& worth, const std::string& rest) {
        const auto read = read_rubric("rubric: r\ntitle: T\nsource: S\nworth: " + worth + "\n" + rest, "r.yaml",
                                      tests::shipped_dictionary());
        std::string all;
        for (const auto& finding : read.findings) all += finding.text() + "\n";
        CHECK(read.rubric.has_value() == read.findings.empty());
        return all;
    };
    const std::string sound =
        "{landing: 40, detection: 20, diagnosis: 10, action: 10, procedure: 10, communication: 10}";
    const std::string rest = "alarms: {within_s: 30, until_s: 300}\npresent_s: 600\ncalls: []\nfaults: []\n";
    CHECK(of(sound, rest).empty());
    CHECK(of("{landing: 40, detection: 20, diagnosis: 10, action: 10, procedure: 10, communication: 9}", rest)
              .find("all together are worth 100, not 99") != std::string::npos);
    CHECK(of(sound, "alarms: {within_s: 30, until_s: 30}\npresent_s: 600\ncalls: []\nfaults: []\n")
              .find("'until_s' must be more than 'within_s'") != std::string::npos);
    CHECK(of(sound, "alarms: {within_s: 30, until_s: 300}\npresent_s: 600\ncalls: [{after: NEVER, note: [x], within_s: "
                    "3}]\nfaults: []\n")
              .find("'NEVER' is neither an event nor a tone") != std::string::npos);
    CHECK(of(sound, "alarms: {within_s: 30, until_s: 300}\npresent_s: 600\ncalls: []\nfaults: [{fault: rain, team: "
                    "[{of: action, note: any, within_s: 3}]}]\n")
              .find("'rain' is no kind of fault") != std::string::npos);
}

TEST_CASE("no text makes the reader of plans fail: a thousand mutations of those that ship", "[instruction][R59]") {
    const PlanLibrary library{shipped_folder, tests::shipped_dictionary()};
    std::mt19937 random{59};
    int sound = 0;
    const auto list = library.list();
    for (const auto& entry : list.plans()) {
        const auto whole = library.plan(entry.name())->text();
        for (int i = 0; i < 250; ++i) {
            auto text = whole;
            for (int changes = 0; changes < 3; ++changes) {
                const auto at = random() % text.size();
                const auto octets = 1 + random() % 12;
                if (random() % 2 == 0)
                    text.erase(at, octets);
                else
                    text.insert(at, whole.substr(random() % whole.size(), octets));
            }
            const auto read = read_plan(text, entry.name() + ".yaml", tests::shipped_dictionary(), {}, possible);
            CHECK(read.plan.has_value() == read.findings.empty());
            if (read.plan) ++sound;
        }
    }
    CHECK(sound > 0);  // in a comment, or in words
}

}  // namespace server_instruction_plan_reader_test
