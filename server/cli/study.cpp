// SPDX-License-Identifier: Apache-2.0
#include "server/cli/study.hpp"

#include "server/campaign/campaign_order.hpp"
#include "server/campaign/campaign_report.hpp"
#include "server/cli/options.hpp"

#include <algorithm>
#include <thread>

namespace aeolis::server {

void add_study(CLI::App& command, StudyOptions& options) {
    constexpr std::uint64_t cases_max = 10'000;  // chosen: of each scenario that is flown
    constexpr unsigned jobs_max = 256;
    command.add_option("--cases", options.cases, "cases each time")
        ->required()
        ->check(whole_number())
        ->check(CLI::Range(std::uint64_t{2}, cases_max));
    command.add_option("--seed", options.seed, "seed of the errors")->check(whole_number())->capture_default_str();
    command.add_option("--jobs", options.jobs, "cases flown at a time; one per processor if left out")
        ->check(whole_number())
        ->check(CLI::Range(1U, jobs_max));
    command.add_option("--folder", options.folder, "where the results are kept, a file each time")
        ->capture_default_str();
}

Result<FlightInputs> study_inputs(const SharedOptions& shared, const std::string& scenario) {
    auto inputs = flight_inputs(shared, scenario);
    if (!inputs) return inputs;
    if (const auto many = campaign::check(inputs->scenario); !many)
        return Error{scenario + ": " + many.error().message};
    return inputs;
}

Result<campaign::CaseTable> table_of(const std::filesystem::path& file) {
    const auto header = campaign::results_header(file);
    if (!header) return header.error();
    auto results = campaign::CampaignResults::open(file, header->cases);
    if (!results) return results.error();
    auto table = results->table();
    if (table && table->numbers.empty()) return Error{file.string() + ": holds no case"};
    return table;
}

Result<campaign::CaseTable> cases_flown(const StudyOptions& options, const simulation::Scenario& scenario,
                                        const dictionary::Dictionary& dictionary, ProgressLine& line) {
    const campaign::Order order{scenario,
                                options.seed,
                                options.cases,
                                options.jobs > 0 ? options.jobs : std::max(1U, std::thread::hardware_concurrency()),
                                campaign::results_file(options.folder, scenario.name, options.seed),
                                false};
    {
        auto store = campaign::open_store(order, dictionary);
        if (!store) return store.error();
        const auto progress =
            campaign::fly(*store, order, dictionary, stop_asked(), [&](const campaign::Progress& so_far) {
                line.draw(scenario.name + " " + campaign::progress_line(so_far));
            });
        if (!progress) return progress.error();
    }
    if (stop_asked()) return Error{"interrupted; what was flown is kept, the same call goes on"};
    return table_of(order.file);
}

}  // namespace aeolis::server
