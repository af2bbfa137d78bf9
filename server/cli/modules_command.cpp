// SPDX-License-Identifier: Apache-2.0
#include "server/cli/commands.hpp"
#include "server/cli/options.hpp"
#include "server/cli/shipped_paths.hpp"
#include "server/rehearsal/rehearsal.hpp"
#include "server/venue/message_flow.hpp"

#include <fmt/format.h>
#include <memory>

namespace aeolis::server {
namespace {

struct ModulesOptions {
    SharedOptions shared;
    std::string scenario = "nominal_auto";
    std::uint64_t seed = 1;
};

/// Prints the flight software's modules, messages, rates and priorities as a document.
int modules(const ModulesOptions& options) {
    const auto ready = flight_inputs(options.shared, options.scenario);
    if (!ready) return failed(ready.error().message);
    const auto& [dictionary, scenario] = *ready;
    const auto flow = std::make_shared<MessageFlow>();
    Rehearsal rehearsal{scenario, options.seed, 0, dictionary, flow};
    while (!rehearsal.finished()) {
        rehearsal.step();
        rehearsal.take_stages();
    }
    if (flow->cycles() == 0)
        return failed(
            fmt::format("{}: no computer runs in the test venue {}", options.scenario, name_of(scenario.test_venue)));
    if (rehearsal.outcome() != archive::Outcome::touchdown)
        return failed(fmt::format("{}: the landing that is counted ended as {} {}", options.scenario,
                                  name_of(rehearsal.outcome()), rehearsal.outcome_reason()));
    fmt::print("{}", flow->document(fmt::format("`{}`, seed {}", scenario.name, options.seed)));
    return 0;
}

}  // namespace

void add_modules_command(CLI::App& program, int& exit_code) {
    const auto options = std::make_shared<ModulesOptions>();
    auto& command = *program.add_subcommand(
        "modules", "prints the flight software's modules, messages, rates and priorities as Markdown");
    command.add_option("--scenario", options->scenario, "scenario whose landing is counted")->capture_default_str();
    command.add_option("--seed", options->seed, "seed of the errors")->check(whole_number())->capture_default_str();
    add_shared(command, options->shared);
    command.callback([options, &exit_code] { exit_code = modules(*options); });
}

}  // namespace aeolis::server
