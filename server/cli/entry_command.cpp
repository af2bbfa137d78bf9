// SPDX-License-Identifier: Apache-2.0
#include "server/cli/commands.hpp"
#include "server/cli/options.hpp"
#include "server/cli/shipped_paths.hpp"
#include "simulation/entry_reference.hpp"

#include <fmt/format.h>
#include <memory>

namespace aeolis::server {
namespace {

struct EntryReferenceOptions {
    SharedOptions shared;
    std::string scenario;
};

/// Prints the entry guidance tables of a scenario as CSV.
int entry_reference(const EntryReferenceOptions& options) {
    const auto scenario = scenario_given(options.scenario, options.shared.scenarios);
    if (!scenario) return failed(scenario.error().message);
    const flight::EntryReference reference = simulation::make_entry_reference(*scenario);
    fmt::print("velocity_mps,range_to_go_m,drag_mps2,altitude_rate_mps,d_range_d_drag_s2,d_range_d_altitude_rate_s,"
               "d_range_d_lift_to_drag_m,lift_to_drag\n");
    for (std::uint32_t i = 0; i < reference.row_count; ++i) {
        const flight::EntryReferenceRow& row = reference.rows[i];
        fmt::print("{:.3f},{:.1f},{:.5f},{:.4f},{:.2f},{:.3f},{:.1f},{:.5f}\n", row.velocity_mps, row.range_to_go_m,
                   row.drag_mps2, row.altitude_rate_mps, row.d_range_d_drag_s2, row.d_range_d_altitude_rate_s,
                   row.d_range_d_lift_to_drag_m, row.lift_to_drag);
    }
    return 0;
}

}  // namespace

void add_entry_command(CLI::App& program, int& exit_code) {
    const auto options = std::make_shared<EntryReferenceOptions>();
    auto& command = *program.add_subcommand("entry", "prints tables of entry guidance");
    command.require_subcommand(1);
    auto& reference = *command.add_subcommand(
        "reference", "prints the tables that entry guidance follows, flown from the scenario (CSV)");
    reference.add_option("--scenario", options->scenario, "a file, or the name of a shipped one")->required();
    add_shared(reference, options->shared);
    reference.callback([options, &exit_code] { exit_code = entry_reference(*options); });
}

}  // namespace aeolis::server
