// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "server/campaign/campaign.hpp"
#include "simulation/scenario.hpp"

#include <filesystem>

namespace aeolis::server::campaign {

/// A campaign as it is asked for: the cases 1 … `cases` of a scenario that can be flown, into a file.
struct Order {
    simulation::Scenario scenario;
    std::uint64_t seed = 1;
    std::uint64_t cases = 1;
    unsigned jobs = 1;  ///< cases at a time
    std::filesystem::path file;
    bool gives_way =
        false;  ///< what flies runs only where nobody else wants the processor; the thread that keeps does not give way
};

/// Where the results of this scenario and seed lie in a folder.
std::filesystem::path results_file(const std::filesystem::path& folder, const std::string& scenario,
                                   std::uint64_t seed);

/// An Error names why cases of this scenario cannot be flown beside each other.
Result<void> check(const simulation::Scenario& scenario);

/// The order's file, for the program that runs: made, or gone on with. An Error names what it belongs to instead.
Result<CampaignStore> open_store(const Order& order, const dictionary::Dictionary& dictionary);

/// Flies what the store lacks. What is in flight when `stop` is set is abandoned within a cycle.
Result<Progress> fly(CampaignStore& store, const Order& order, const dictionary::Dictionary& dictionary,
                     const std::atomic<bool>& stop, const std::function<void(const Progress&)>& tell);

}  // namespace aeolis::server::campaign
