// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/campaign_order.hpp"
#include "server/campaign/campaign_plots.hpp"
#include "server/campaign/campaign_report.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/long_work.hpp"
#include "server/cli/shipped_paths.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <thread>

namespace aeolis::server {
namespace {

unsigned jobs_of(const CampaignOptions& options) {
    return options.jobs > 0 ? options.jobs : std::max(1U, std::thread::hardware_concurrency());
}

Result<campaign::Call> flown(const CampaignOptions& options, const campaign::Order& order,
                             const dictionary::Dictionary& dictionary) {
    auto store = campaign::open_store(order, dictionary);
    if (!store) return store.error();
    stop_at_interrupt();
    ProgressLine line;
    const auto progress = campaign::fly(*store, order, dictionary, stop_asked(), [&](const campaign::Progress& so_far) {
        line.draw(campaign::progress_line(so_far));
    });
    if (!progress) return progress.error();
    return campaign::Call{*progress, order.jobs, options.scenario, order.file.string()};
}

}  // namespace

int run_campaign(const CampaignOptions& options) {
    const auto ready = flyable(options.shared, options.scenario);
    if (!ready) return failed(ready.error().message);
    const auto& [dictionary, scenario] = *ready;
    if (const auto many = campaign::check(scenario); !many)
        return failed(options.scenario + ": " + many.error().message);

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
    if (options.json)
        fmt::print("{}\n", campaign::campaign_json(*summary, *call));
    else
        fmt::print("{}", campaign::campaign_table(*summary, *call));
    if (options.plots)
        if (const auto drawn = campaign::write_plots(*results, *summary, *options.plots); !drawn)
            return failed(drawn.error().message);
    return summary->kept == summary->cases && summary->failed == 0 ? 0 : 1;
}

}  // namespace aeolis::server
