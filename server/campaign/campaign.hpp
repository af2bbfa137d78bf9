// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/campaign/campaign_store.hpp"

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace aeolis::server::campaign {

/// A worker on another machine, and the cases that it flew in this call.
struct WorkerShare {
    std::string name;
    std::uint64_t flown = 0;
};

/// A case that is not tried again in this call.
struct SetAside {
    std::uint64_t number = 0;
    std::string reason;
};

/// Progress of a campaign.
struct Progress {
    std::uint64_t done = 0;  ///< cases stored or flown, including those of earlier calls
    std::uint64_t of = 0;
    std::uint64_t flown = 0;  ///< in this call
    double wall_s = 0.0;      ///< of this call
    // Of workers on other machines; empty without them.
    std::vector<WorkerShare> workers{};
    std::vector<SetAside> set_aside{};
    std::uint64_t refused_answers = 0;  ///< of another campaign, of cases not asked for, or not understood
    std::string waiting_for{};          ///< what the campaign waits for, in words; empty: nothing
    double rate_per_s() const { return wall_s > 0.0 ? static_cast<double>(flown) / wall_s : 0.0; }
};

/// Flies the cases among 1 … `cases` that the store lacks, on `jobs` threads, and stores their results.
///
/// In       fly(case): called from `jobs` threads; none when abandoned because of `stop`. tell(progress): called on the
///          calling thread, ten times a second
/// Commit   a flown case is durable at most a second later
/// End      all cases stored, or `stop` was set: then flown cases are stored and no other case begins
/// Memory   a few cases per thread, however many there are
/// Faults   a failed write to the store ends the campaign; an exception in a case ends that case as lost
Result<Progress> run_campaign(CampaignStore& store, std::uint64_t cases, unsigned jobs,
                              const std::function<std::optional<CaseResult>(std::uint64_t)>& fly,
                              const std::atomic<bool>& stop, const std::function<void(const Progress&)>& tell);

}  // namespace aeolis::server::campaign
