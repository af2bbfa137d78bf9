#include "server/campaign/campaign_order.hpp"

#include "server/campaign/case_flights.hpp"
#include "server/campaign/program_digest.hpp"
#include "server/scenario/scenario_text.hpp"

#include <fmt/format.h>

namespace aeolis::server::campaign {

std::filesystem::path results_file(const std::filesystem::path& folder, const std::string& scenario, std::uint64_t seed) {
    return folder / fmt::format("campaign-{}-{}.db", scenario, seed);
}

Result<void> check(const simulation::Scenario& scenario) {
    if (scenario.test_venue != simulation::TestVenue::performance) return {};
    return Error{"test_venue: performance times one landing; a campaign flies many at once"};
}

Result<CampaignStore> open_store(const Order& order, const dictionary::Dictionary& dictionary) {
    auto program = program_digest();
    if (!program) return program.error();
    auto store = CampaignStore::open(order.file, {order.scenario.name, scenario_to_text(order.scenario), order.seed,
                                                  fmt::format("{}", dictionary.id), std::move(*program)});
    if (!store) return store;
    if (const auto wanted = store->want(order.cases); !wanted) return wanted.error();
    return store;
}

Result<Progress> fly(CampaignStore& store, const Order& order, const dictionary::Dictionary& dictionary,
                     const std::atomic<bool>& stop, const std::function<void(const Progress&)>& tell) {
    const CaseFlights flights{order.scenario, order.seed, dictionary, stop};
    return run_campaign(store, order.cases, order.jobs, [&](std::uint64_t number) { return flights.fly(number); }, stop, tell);
}

} // namespace aeolis::server::campaign
