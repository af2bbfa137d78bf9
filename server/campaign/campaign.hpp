// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/campaign/campaign_store.hpp"

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>

namespace aeolis::server::campaign {

/// How far a campaign has come.
struct Progress {
    std::uint64_t done = 0;  ///< cases that are kept or flown, earlier calls' too
    std::uint64_t of = 0;
    std::uint64_t flown = 0;  ///< in this call
    double wall_s = 0.0;      ///< of this call
    double rate_per_s() const { return wall_s > 0.0 ? static_cast<double>(flown) / wall_s : 0.0; }
};

/// Flies the cases 1 … `cases` that the store does not have, on `jobs` threads, and keeps them as they come.
///
/// In       fly(case): from `jobs` threads at once, none when it was abandoned because of `stop`; tell(progress): from
///          the calling one, ten times a second
/// Commit   what is flown is durable at most a second later
/// End      all cases kept; or `stop` was set: what has been flown is kept, no other case begins
/// Memory   a few cases a thread, whatever their number
/// Faults   what the store cannot take ends the campaign; what a case throws ends that case as lost
Result<Progress> run_campaign(CampaignStore& store, std::uint64_t cases, unsigned jobs,
                              const std::function<std::optional<CaseResult>(std::uint64_t)>& fly,
                              const std::atomic<bool>& stop, const std::function<void(const Progress&)>& tell);

}  // namespace aeolis::server::campaign
