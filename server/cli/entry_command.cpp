// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/targeting.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/long_work.hpp"
#include "server/cli/options.hpp"
#include "server/cli/shipped_paths.hpp"
#include "server/cli/study.hpp"
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
    const flight::EntryReference reference = simulation::make_entry_reference(simulation::as_believed(*scenario));
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

struct EntryTargetOptions {
    SharedOptions shared;
    std::string scenario;
    StudyOptions study;
    double tolerance_m = 0.0;
    std::size_t rounds = 0;
};

/// Moves the aim of guidance until the mean of the landings meets the target, and prints what to write into the
/// scenario. Exit code 1: it was not met.
int entry_target(const EntryTargetOptions& options) {
    const auto ready = study_inputs(options.shared, options.scenario);
    if (!ready) return failed(ready.error().message);
    const auto& [dictionary, scenario] = *ready;
    stop_at_interrupt();
    const auto targeting = [&] {
        ProgressLine line;
        return campaign::aim_at_target(
            campaign::aim_of(scenario), options.tolerance_m, options.rounds, [&](const campaign::Aim& aim) {
                return cases_flown(options.study, campaign::with_aim(scenario, aim), dictionary, line);
            });
    }();
    if (!targeting) return failed("entry target: " + targeting.error().message);
    fmt::print("{} (seed {}): where guidance aims, and where the cases land, from the target\n\n{}\n", scenario.name,
               options.study.seed, campaign::targeting_table(*targeting));
    const campaign::AimedLandings& last = targeting->rounds.back();
    if (!targeting->reached)
        return failed(fmt::format("entry target: after {} {} the mean still misses by {:.0f} m, more than {:g}",
                                  targeting->rounds.size(), targeting->rounds.size() == 1 ? "round" : "rounds",
                                  last.miss_m(), options.tolerance_m));
    fmt::print(
        "In the scenario (the mean of these {} landings is itself known to {:.0f} m east and {:.0f} m north, one "
        "sigma):\n\n    guidance {{ aim_east_m: {:.0f} aim_north_m: {:.0f} }}\n",
        last.landed, last.east_sigma_m, last.north_sigma_m, last.aim.east_m, last.aim.north_m);
    return 0;
}

}  // namespace

void add_entry_command(CLI::App& program, int& exit_code) {
    const auto options = std::make_shared<EntryReferenceOptions>();
    auto& command = *program.add_subcommand("entry", "prints tables of entry guidance, and aims it");
    command.require_subcommand(1);
    auto& reference = *command.add_subcommand(
        "reference", "prints the tables that entry guidance follows, flown from the scenario (CSV)");
    reference.add_option("--scenario", options->scenario, "a file, or the name of a shipped one")->required();
    add_shared(reference, options->shared);
    reference.callback([options, &exit_code] { exit_code = entry_reference(*options); });

    const auto aimed = std::make_shared<EntryTargetOptions>();
    auto& target = *command.add_subcommand(
        "target", "moves the point at which guidance aims until the mean of dispersed landings meets the target");
    target.add_option("--scenario", aimed->scenario, "a file, or the name of a shipped one")->required();
    add_study(target, aimed->study);
    target.add_option("--tolerance-m", aimed->tolerance_m, "miss of the mean that is met")
        ->default_val(50.0)  // NOLINT(readability-magic-numbers): chosen
        ->check(CLI::Range(1.0, 10'000.0));
    target.add_option("--rounds", aimed->rounds, "tries at most, each with all cases")
        ->default_val(5)  // NOLINT(readability-magic-numbers): chosen
        ->check(whole_number())
        ->check(CLI::Range(1U, 20U));
    add_shared(target, aimed->shared);
    target.callback([aimed, &exit_code] { exit_code = entry_target(*aimed); });
}

}  // namespace aeolis::server
