// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

// The subcommands of `aeolis`. Each function adds one to the program, with its options and its callback, which sets
// `exit_code`: 0 done, 1 failed or found something, 2 wrong use, 3 unknown whether it was done.
namespace aeolis::server {

void add_accounts_command(CLI::App& program, int& exit_code);
void add_archive_command(CLI::App& program, int& exit_code);
void add_campaign_command(CLI::App& program, int& exit_code);
void add_decode_command(CLI::App& program, int& exit_code);
void add_dictionary_command(CLI::App& program, int& exit_code);
void add_entry_command(CLI::App& program, int& exit_code);
void add_export_command(CLI::App& program, int& exit_code);
void add_forecast_command(CLI::App& program, int& exit_code);
void add_ingest_command(CLI::App& program, int& exit_code);
void add_modules_command(CLI::App& program, int& exit_code);
void add_overlay_command(CLI::App& program, int& exit_code);
void add_parameters_command(CLI::App& program, int& exit_code);
void add_plan_command(CLI::App& program, int& exit_code);
void add_procedure_command(CLI::App& program, int& exit_code);
void add_reconstruct_command(CLI::App& program, int& exit_code);
void add_rehearse_command(CLI::App& program, int& exit_code);
void add_report_command(CLI::App& program, int& exit_code);
void add_send_command(CLI::App& program, int& exit_code);
void add_serve_command(CLI::App& program, int& exit_code);
void add_timeline_command(CLI::App& program, int& exit_code);
void add_tones_command(CLI::App& program, int& exit_code);
void add_worker_command(CLI::App& program, int& exit_code);

/// Adds the subcommands of `campaign` that study what was flown.
void add_campaign_analysis(CLI::App& campaign, int& exit_code);
/// Adds `samples`, a subcommand of `archive` that shares its options with `export`.
void add_archive_samples(CLI::App& archive, int& exit_code);

}  // namespace aeolis::server
