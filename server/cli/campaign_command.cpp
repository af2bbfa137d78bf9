// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/campaign_order.hpp"
#include "server/campaign/campaign_plots.hpp"
#include "server/campaign/campaign_report.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/long_work.hpp"
#include "server/cli/options.hpp"
#include "server/cli/shipped_paths.hpp"
#include "server/cli/study.hpp"
#include "server/cluster/case_collector.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <memory>
#include <spdlog/spdlog.h>
#include <thread>

namespace aeolis::server {
namespace {

constexpr std::uint64_t campaign_cases_max = 10'000'000;  // chosen: a month on many processors
constexpr unsigned campaign_jobs_max = 256;               // chosen: each holds a landing

struct CampaignOptions {
    SharedOptions shared;
    std::string scenario;
    std::uint64_t cases = 0, seed = 1;
    unsigned jobs = 0;                             ///< 0: one per processor
    std::optional<std::filesystem::path> results;  ///< none: run-data/campaign-SCENARIO-SEED.db
    std::optional<std::filesystem::path> plots;    ///< a directory
    cluster::EngineAddress nats;                   ///< whose workers fly the cases; no URL: flown here
    bool json = false;
};

unsigned jobs_of(const CampaignOptions& options) {
    return options.jobs > 0 ? options.jobs : std::max(1U, std::thread::hardware_concurrency());
}

Result<campaign::Progress> flown_elsewhere(const CampaignOptions& options, const campaign::Order& order,
                                           const dictionary::Dictionary& dictionary, campaign::CampaignStore& store,
                                           const std::function<void(const campaign::Progress&)>& tell) {
    const auto identity = campaign::identity_of(order, dictionary);
    if (!identity) return identity.error();
    auto engine = cluster::Engine::connect(options.nats, "aeolis campaign " + order.scenario.name);
    if (!engine) return engine.error();
    return cluster::collect(store, *identity, order.cases, *engine, stop_asked(), tell);
}

Result<campaign::Call> flown(const CampaignOptions& options, const campaign::Order& order,
                             const dictionary::Dictionary& dictionary) {
    auto store = campaign::open_store(order, dictionary);
    if (!store) return store.error();
    stop_at_interrupt();
    ProgressLine line;
    std::string waiting_for;
    const auto draw = [&](const campaign::Progress& so_far) {
        if (so_far.waiting_for != waiting_for && !so_far.waiting_for.empty()) spdlog::warn("{}", so_far.waiting_for);
        waiting_for = so_far.waiting_for;
        line.draw(campaign::progress_line(so_far));
    };
    const auto progress = options.nats.url.empty() ? campaign::fly(*store, order, dictionary, stop_asked(), draw)
                                                   : flown_elsewhere(options, order, dictionary, *store, draw);
    if (!progress) return progress.error();
    return campaign::Call{*progress, order.jobs, options.scenario, order.file.string(), cluster::shown(options.nats)};
}

/// Returns 0 when all cases are flown and the campaign passes by the scenario's limits.
int run_campaign(const CampaignOptions& options) {
    const auto ready = study_inputs(options.shared, options.scenario);
    if (!ready) return failed(ready.error().message);
    const auto& [dictionary, scenario] = *ready;

    const campaign::Order order{
        scenario,
        options.seed,
        options.cases,
        jobs_of(options),
        options.results.value_or(campaign::results_file("run-data", scenario.name, options.seed)),
        false};
    const auto& file = order.file;
    const auto call = flown(options, order, dictionary);
    if (!call) return failed(call.error().message);

    auto results = campaign::CampaignResults::open(file, options.cases);
    if (!results) return failed(results.error().message);
    const auto summary = results->summary();
    if (!summary) return failed(summary.error().message);
    const auto verdict = results->verdict();
    if (!verdict) return failed(verdict.error().message);
    if (options.json)
        fmt::print("{}\n", campaign::campaign_json(*summary, *verdict, *call));
    else
        fmt::print("{}", campaign::campaign_table(*summary, *verdict, *call));
    if (options.plots)
        if (const auto drawn = campaign::write_plots(*results, *summary, *options.plots); !drawn)
            return failed(drawn.error().message);
    return summary->kept == summary->cases && verdict->passes() ? 0 : 1;
}

}  // namespace

void add_campaign_command(CLI::App& program, int& exit_code) {
    const auto options = std::make_shared<CampaignOptions>();
    auto& command = *program.add_subcommand(
        "campaign",
        "flies dispersed landings and prints statistics; continues where an earlier call ended; exit code 1 when fewer "
        "cases than the scenario requires landed within its limits");
    command.require_subcommand(0, 1);
    auto& scenario = *command.add_option("--scenario", options->scenario, "a file, or the name of a shipped one");
    auto& cases = *command.add_option("--cases", options->cases, "cases 1 … N, each as rehearse --case flies it")
                       ->check(whole_number())
                       ->check(CLI::Range(std::uint64_t{1}, campaign_cases_max));
    command.add_option("--seed", options->seed, "seed of the errors")->check(whole_number())->capture_default_str();
    auto& jobs = *command.add_option("--jobs", options->jobs, "cases flown at a time; one per processor if left out")
                      ->check(whole_number())
                      ->check(CLI::Range(1U, campaign_jobs_max));
    add_engine(command, options->nats, "have the workers of this NATS engine fly the cases (aeolis worker)")
        ->excludes(&jobs);
    command.add_option("--results", options->results,
                       "SQLite file of the cases; run-data/campaign-SCENARIO-SEED.db if left out");
    command.add_option("--plots", options->plots, "write pictures (SVG) into this directory");
    command.add_flag("--json", options->json, "print one JSON object");
    add_shared(command, options->shared);
    add_campaign_analysis(command, exit_code);
    command.callback([options, &command, &scenario, &cases, &exit_code] {
        if (!command.get_subcommands().empty()) return;
        for (const CLI::Option* needed : {&scenario, &cases})
            if (needed->empty()) throw CLI::RequiredError(needed->get_name());
        exit_code = run_campaign(*options);
    });
}

}  // namespace aeolis::server
