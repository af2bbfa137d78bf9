// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/campaign/campaign.hpp"
#include "server/campaign/campaign_store.hpp"
#include "server/cluster/engine.hpp"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>

namespace aeolis::server::cluster {

/// How long a collector waits. Chosen; tests wait less.
struct CollectorTimes {
    std::chrono::milliseconds store_every{500};  ///< longest time until an answer is durable
    std::chrono::seconds quiet{15};        ///< without an answer: the queue is asked whether it still has the cases
    std::chrono::seconds again_after{30};  ///< a worker that is silent for so long has lost its case
};

/// Queues the cases among 1 … `cases` that the store lacks, for the workers of the engine, and stores each answer once.
///
/// In       `identity` as the store has it. tell(progress): called on the calling thread, ten times a second
/// Commit   an answer is durable when it is taken out of the queue: whoever dies, no case is lost and none is twice
///          in the file
/// End      all cases are stored or set aside, or `stop` was set. Then the queue is emptied: no further case begins
/// Memory   the numbers of the cases that wait, at most two thousand
/// Faults   a failed write to the store ends the campaign. An engine that is away is waited for, and named in
///          `waiting_for`; what it lost is queued again
Result<campaign::Progress> collect(campaign::CampaignStore& store, const campaign::Identity& identity,
                                   std::uint64_t cases, Engine& engine, const std::atomic<bool>& stop,
                                   const std::function<void(const campaign::Progress&)>& tell,
                                   const CollectorTimes& times = {});

}  // namespace aeolis::server::cluster
