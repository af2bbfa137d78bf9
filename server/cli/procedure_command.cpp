// SPDX-License-Identifier: Apache-2.0
#include "server/api/procedure_library.hpp"
#include "server/base/json_object.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/options.hpp"
#include "server/cli/shipped_paths.hpp"
#include "server/instruction/plan_library.hpp"
#include "server/procedures/procedure_text.hpp"

#include <cstdio>
#include <fmt/format.h>
#include <memory>

namespace aeolis::server {
namespace {

using procedures::ReadProcedure;
using procedures::TextFinding;
using Files = std::vector<std::filesystem::path>;

struct ProcedureOptions {
    std::filesystem::path dictionary = SharedOptions{}.dictionary;
    Files files;
    bool json = false;
};

/// "1 step", "2 steps".
std::string counted(std::size_t count, const char* what) {
    return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

std::string finding_json(const TextFinding& finding) {
    return JsonObject{}
        .count("line", finding.mark.line)
        .count("column", finding.mark.column)
        .text("message", finding.message)
        .str();
}

std::string procedure_json(const std::filesystem::path& file, const ReadProcedure& read) {
    JsonObject object;
    object.text("file", file.string());
    if (read.procedure) {
        object.text("procedure", read.procedure->id).count("revision", read.procedure->revision);
        object.raw("approved", read.procedure->approvals.empty() ? "false" : "true");
        object.count("steps", read.procedure->preconditions.size() + read.procedure->body.size() +
                                  read.procedure->confirmation.size());
        object.count("watchdogs", read.procedure->watchdogs.size());
    }
    return object.raw("findings", json_array(read.findings, finding_json)).str();
}

/// Returns 0 when no file breaks a rule, 1 when one does, 2 when one cannot be read.
int procedure_check(const ProcedureOptions& options) {
    const auto dictionary = loaded_dictionary(options.dictionary);
    if (!dictionary) return 1;
    const Files files =
        options.files.empty() ? instruction::yaml_files_in(options.dictionary / "procedures") : options.files;
    if (files.empty())
        return failed(fmt::format("procedure check: {} has no procedures", options.dictionary.string()), 2);
    bool sound = true;
    std::vector<std::string> reports;
    reports.reserve(files.size());
    for (const auto& file : files) {
        const auto found = read_procedure_file(file, file.string(), *dictionary);
        if (!found) return failed("procedure check: " + found.error().message, 2);
        const ReadProcedure* read = &found->read;
        sound = sound && read->procedure.has_value();
        if (options.json) {
            reports.push_back(procedure_json(file, *read));
            continue;
        }
        for (const TextFinding& finding : read->findings) fmt::print(stderr, "{}\n", finding.text());
        if (read->procedure)
            fmt::print("{}: no rule is broken: revision {}, {}, {}, {}, {}, {}\n", file.string(),
                       read->procedure->revision, read->procedure->approvals.empty() ? "a draft" : "approved",
                       counted(read->procedure->preconditions.size(), "precondition"),
                       counted(read->procedure->body.size(), "step"),
                       counted(read->procedure->watchdogs.size(), "watchdog"),
                       counted(read->procedure->confirmation.size(), "confirmation"));
    }
    if (options.json)
        fmt::print("{}\n", JsonObject{}.raw("procedures", json_array(reports, [](auto text) { return text; })).str());
    return sound ? 0 : 1;
}

int procedure_print(const ProcedureOptions& options) {
    const auto dictionary = loaded_dictionary(options.dictionary);
    if (!dictionary) return 1;
    const auto found = read_procedure_file(options.files.front(), options.files.front().string(), *dictionary);
    if (!found) return failed("procedure print: " + found.error().message, 2);
    const ReadProcedure* read = &found->read;
    for (const TextFinding& finding : read->findings) fmt::print(stderr, "{}\n", finding.text());
    if (!read->procedure) return 1;
    fmt::print("{}", procedures::printed(*read->procedure, *dictionary));
    return 0;
}

}  // namespace

void add_procedure_command(CLI::App& program, int& exit_code) {
    auto& procedure = *program.add_subcommand("procedure", "checks and prints the procedures of the control room");
    procedure.require_subcommand(1);
    const auto options = std::make_shared<ProcedureOptions>();
    const auto add_dictionary = [&](CLI::App& command) {
        command.add_option("--dictionary", options->dictionary, "the dictionary's directory")->capture_default_str();
    };
    auto& check = *procedure.add_subcommand(
        "check", "checks every rule, and names each fault with file, line and column; exit code 1 when there is one");
    check.add_option("FILE", options->files, "procedures in YAML; without any, those of the dictionary");
    add_dictionary(check);
    check.add_flag("--json", options->json, "print one JSON object");
    check.callback([options, &exit_code] { exit_code = procedure_check(*options); });

    auto& print = *procedure.add_subcommand("print", "prints a procedure as plain text, to be ticked and signed");
    print.add_option("FILE", options->files, "a procedure in YAML")->required()->expected(1);
    add_dictionary(print);
    print.callback([options, &exit_code] { exit_code = procedure_print(*options); });
}

}  // namespace aeolis::server
