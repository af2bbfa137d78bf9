// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/campaign_order.hpp"

#include "server/campaign/case_flights.hpp"
#include "server/campaign/program_digest.hpp"
#include "server/scenario/scenario_text.hpp"

#include <fmt/format.h>
#include <future>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

namespace aeolis::server::campaign {

void use_idle_priority() {
    constexpr int lowest = 19;
    const sched_param none{};
    if (sched_setscheduler(0, SCHED_IDLE, &none) != 0) setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), lowest);
}

std::filesystem::path results_file(const std::filesystem::path& folder, const std::string& scenario,
                                   std::uint64_t seed) {
    return folder / fmt::format("campaign-{}-{}.db", scenario, seed);
}

Result<void> check(const simulation::Scenario& scenario) {
    if (scenario.test_venue != simulation::TestVenue::performance) return {};
    return Error{"test_venue: performance times one landing; a campaign flies many at once"};
}

Result<Identity> identity_of(const Order& order, const dictionary::Dictionary& dictionary) {
    auto program = program_digest();
    if (!program) return program.error();
    return Identity{order.scenario.name, scenario_to_text(order.scenario), order.seed, fmt::format("{}", dictionary.id),
                    std::move(*program)};
}

Result<CampaignStore> open_store(const Order& order, const dictionary::Dictionary& dictionary) {
    const auto identity = identity_of(order, dictionary);
    if (!identity) return identity.error();
    auto store = CampaignStore::open(order.file, *identity);
    if (!store) return store;
    if (const auto wanted = store->want(order.cases); !wanted) return wanted.error();
    return store;
}

Result<Progress> fly(CampaignStore& store, const Order& order, const dictionary::Dictionary& dictionary,
                     const std::atomic<bool>& stop, const std::function<void(const Progress&)>& tell) {
    // Not on the storing thread: that shares SQLite's locks with the server's writer and must not be descheduled while
    // it holds one.
    const auto flights = std::async(std::launch::async, [&] {
                             if (order.idle_priority) use_idle_priority();
                             return std::make_unique<const CaseFlights>(order.scenario, order.seed, dictionary, stop);
                         }).get();
    const auto fly_case = [&](std::uint64_t number) {
        if (order.idle_priority) use_idle_priority();
        return flights->fly(number);
    };
    return run_campaign(store, order.cases, order.jobs, fly_case, stop, tell);
}

}  // namespace aeolis::server::campaign
