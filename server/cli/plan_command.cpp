// SPDX-License-Identifier: Apache-2.0
#include "server/base/json_object.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/options.hpp"
#include "server/cli/shipped_paths.hpp"
#include "server/instruction/plan_library.hpp"
#include "server/scenario/scenario_text.hpp"

#include <cstdio>
#include <fmt/format.h>
#include <memory>

namespace aeolis::server {
namespace {

using instruction::InjectPlan;

struct PlanOptions {
    SharedOptions shared;
    std::vector<std::filesystem::path> files;
    std::string scenario;
    bool json = false;
};

std::string plan_json(const std::filesystem::path& file, const instruction::ReadPlan& read) {
    JsonObject object;
    object.text("file", file.string());
    if (read.plan) object.text("plan", read.plan->id).count("injects", read.plan->injects.size());
    return object
        .raw("findings", json_array(read.findings,
                                    [](const procedures::TextFinding& finding) {
                                        return JsonObject{}
                                            .count("line", finding.mark.line)
                                            .count("column", finding.mark.column)
                                            .text("message", finding.message)
                                            .str();
                                    }))
        .str();
}

/// A line for each inject: when, and what.
void print_plan(const std::filesystem::path& file, const InjectPlan& plan, const dictionary::Dictionary& dictionary) {
    fmt::print("{}: no rule is broken: {}\n", file.string(), plan.title);
    for (const auto& inject : plan.injects) {
        const auto when = instruction::when_text(inject, dictionary);
        fmt::print("  {:<20}  {}: {}\n", inject.id, when.empty() ? "by hand" : when,
                   instruction::text_of(inject.fault));
    }
}

/// Returns 0 when no file breaks a rule, 1 when one does, 2 when one cannot be read.
int plan_check(const PlanOptions& options) {
    const auto dictionary = loaded_dictionary(options.shared.dictionary);
    if (!dictionary) return 1;
    const auto files =
        options.files.empty() ? instruction::yaml_files_in(options.shared.dictionary / "plans") : options.files;
    if (files.empty()) return failed(fmt::format("plan check: {} has no plans", options.shared.dictionary.string()), 2);
    const instruction::PlanLibrary shipped{options.shared.dictionary, *dictionary};
    const auto library_text = shipped.injects_text();
    const auto read_injects = instruction::read_library(library_text, "injects.yaml", *dictionary, {});
    bool sound = library_text.empty() || read_injects.injects.has_value();
    if (!sound)
        for (const auto& finding : read_injects.findings) fmt::print(stderr, "{}\n", finding.text());
    if (const auto calls = shipped.calls(); !calls) {
        fmt::print(stderr, "{}\n", calls.error().message);
        sound = false;
    }
    const auto library = read_injects.injects.value_or(std::vector<instruction::Inject>{});
    std::vector<std::string> reports;
    for (const auto& file : files) {
        const auto text = instruction::text_of_file(file);
        if (!text) return failed("plan check: " + text.error().message, 2);
        const auto first = instruction::read_plan(*text, file.string(), *dictionary, library, {});
        const auto& of = first.plan && !first.plan->scenario.empty() ? first.plan->scenario : options.scenario;
        const auto scenario = scenario_given(of, options.shared.scenarios);
        if (!scenario) return failed("plan check: " + scenario.error().message, 2);
        const auto read =
            instruction::read_plan(*text, file.string(), *dictionary, library, [&](const v1::FaultInjection& fault) {
                const auto possible = fault_from_message(fault, *scenario);
                return possible ? Result<void>{} : Result<void>{possible.error()};
            });
        sound = sound && read.plan.has_value();
        if (options.json) {
            reports.push_back(plan_json(file, read));
            continue;
        }
        for (const auto& finding : read.findings) fmt::print(stderr, "{}\n", finding.text());
        if (read.plan) print_plan(file, *read.plan, *dictionary);
    }
    if (options.json)
        fmt::print("{}\n", JsonObject{}.raw("plans", json_array(reports, [](auto text) { return text; })).str());
    return sound ? 0 : 1;
}

}  // namespace

void add_plan_command(CLI::App& program, int& exit_code) {
    auto& plan = *program.add_subcommand("plan", "checks the plans of instructors");
    plan.require_subcommand(1);
    const auto options = std::make_shared<PlanOptions>();
    options->scenario = "nominal_auto";
    auto& check = *plan.add_subcommand(
        "check", "checks every rule, and names each fault with file, line and column; exit code 1 when there is one");
    check.add_option("FILE", options->files, "plans in YAML; without any, those of the dictionary");
    check.add_option("--dictionary", options->shared.dictionary, "the dictionary's directory")->capture_default_str();
    check
        .add_option("--scenario", options->scenario,
                    "in which its faults must be possible, where the plan names no scenario")
        ->capture_default_str();
    check.add_flag("--json", options->json, "print one JSON object");
    check.callback([options, &exit_code] { exit_code = plan_check(*options); });
}

}  // namespace aeolis::server
