// SPDX-License-Identifier: Apache-2.0
#include "server/base/log_line.hpp"
#include "server/base/version.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/settings_file.hpp"
#include "server/cli/shipped_paths.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <string>
#include <utility>

namespace {

/// The fault of a command line: an unknown command, else the parser's message.
std::string wrong_use(const CLI::App& program, const CLI::ParseError& error, int argc, char** argv) {
    const auto has = [](const CLI::App& command, const std::string& name) {
        return !command.get_subcommands([&](const CLI::App* each) { return each->get_name() == name; }).empty();
    };
    if (argc > 1 && argv[1][0] == '-') return fmt::format("there is no option '{}' (aeolis --help)", argv[1]);
    if (argc > 1 && !has(program, argv[1])) return fmt::format("there is no command '{}' (aeolis --help)", argv[1]);
    if (argc > 2 && argv[2][0] != '-') {
        const auto& command = *program.get_subcommand(argv[1]);
        if (!command.get_subcommands({}).empty() && !has(command, argv[2]))
            return fmt::format("there is no command '{0} {1}' (aeolis {0} --help)", argv[1], argv[2]);
    }
    return fmt::format("{} (aeolis --help)", error.what());
}

}  // namespace

int main(int argc, char** argv) {
    using namespace aeolis::server;
    spdlog::set_default_logger(spdlog::stderr_color_mt("aeolis"));
    spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%e %^%l%$ %v");

    if (setting_given(argc, argv, "log-format") == "json") {  // already for what is wrong with the other options
        print_json();
        spdlog::set_formatter(json_lines());
    }

    CLI::App program{
        "Aeolis lands a spacecraft on Mars and lets you control it from a browser.\n"
        "Exit codes: 0 done, 1 failed or found something, 2 wrong use, 3 unknown whether it was done (send)."};
    program.name("aeolis");
    program.set_version_flag("--version", version);
    program.require_subcommand(1);
    int exit_code = 0;
    add_serve_command(program, exit_code);
    add_rehearse_command(program, exit_code);
    add_entry_command(program, exit_code);
    add_campaign_command(program, exit_code);
    add_worker_command(program, exit_code);
    add_modules_command(program, exit_code);
    add_decode_command(program, exit_code);
    add_dictionary_command(program, exit_code);
    add_parameters_command(program, exit_code);
    add_timeline_command(program, exit_code);
    add_plan_command(program, exit_code);
    add_procedure_command(program, exit_code);
    add_tones_command(program, exit_code);
    add_export_command(program, exit_code);
    add_forecast_command(program, exit_code);
    add_ingest_command(program, exit_code);
    add_send_command(program, exit_code);
    add_report_command(program, exit_code);
    add_reconstruct_command(program, exit_code);
    add_overlay_command(program, exit_code);
    add_accounts_command(program, exit_code);
    add_archive_command(program, exit_code);

    try {
        if (const auto taken = take_settings(program, argc, argv); !taken) return failed(taken.error().message, 2);
        auto words = with_environment(program, argc, argv);
        std::ranges::reverse(words);  // as CLI11 wants them
        program.parse(std::move(words));
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return program.exit(error);  // --help, --version
        return failed(wrong_use(program, error, argc, argv), 2);
    } catch (const std::exception& error) {
        return failed(error.what());
    }
    return exit_code;
}
