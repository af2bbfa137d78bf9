// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "server/campaign/campaign.hpp"
#include "simulation/scenario.hpp"

#include <filesystem>

namespace aeolis::server::campaign {

/// A campaign to be flown: the cases 1 … `cases` of a scenario, stored in a file.
struct Order {
    simulation::Scenario scenario;
    std::uint64_t seed = 1;
    std::uint64_t cases = 1;
    unsigned jobs = 1;  ///< cases flown at a time
    std::filesystem::path file;
    bool idle_priority = false;  ///< cases fly only while the processor is idle; the storing thread excepted
};

/// Gives the calling thread the lowest priority from now on: it runs only while nothing else wants the processor.
void use_idle_priority();

/// The file in a folder for the results of this scenario and seed.
std::filesystem::path results_file(const std::filesystem::path& folder, const std::string& scenario,
                                   std::uint64_t seed);

/// Whether cases of this scenario can be flown in parallel. The Error says why not.
Result<void> check(const simulation::Scenario& scenario);

/// What the order's cases have in common, flown by the running program.
Result<Identity> identity_of(const Order& order, const dictionary::Dictionary& dictionary);

/// Creates or reopens the order's file for the running program. The Error names what else the file belongs to.
Result<CampaignStore> open_store(const Order& order, const dictionary::Dictionary& dictionary);

/// Flies the cases that the store lacks. Once `stop` is set, cases in flight are abandoned within a cycle.
Result<Progress> fly(CampaignStore& store, const Order& order, const dictionary::Dictionary& dictionary,
                     const std::atomic<bool>& stop, const std::function<void(const Progress&)>& tell);

}  // namespace aeolis::server::campaign
