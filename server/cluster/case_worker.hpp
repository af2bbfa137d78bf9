// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/cluster.pb.h"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/campaign/campaign_store.hpp"
#include "server/campaign/case_result.hpp"
#include "server/cluster/engine.hpp"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace aeolis::server::cluster {

struct WorkerSettings {
    std::string name;                            ///< as the collector shows it
    unsigned jobs = 1;                           ///< cases flown at a time
    std::chrono::milliseconds look_every{1000};  ///< for campaigns that begin and end
    std::chrono::seconds speak_every{10};        ///< for a case in flight, so that nobody else is given it
};

struct WorkerProgress {
    std::uint64_t flown = 0, set_aside = 0;
    double wall_s = 0.0;
    std::size_t campaigns = 0;            ///< that this worker takes part in
    std::vector<std::string> left_out{};  ///< why campaigns of the engine are not flown here, a line each
    std::string waiting_for{};            ///< the engine's fault, in words; empty: none
};

/// Flies one case; none: it was abandoned because of `stop`.
using FlyCase = std::function<std::optional<campaign::CaseResult>(std::uint64_t)>;
/// Prepares for the cases of a campaign. The Error says why they cannot be flown here.
using BeginCampaign = std::function<Result<FlyCase>(const v1::CampaignOrder& order)>;

/// Reads the order's scenario; its cases are landings, whose common part is flown with the first one.
BeginCampaign landings(const dictionary::Dictionary& dictionary, const std::atomic<bool>& stop);

/// Flies cases of the engine's campaigns until `stop` is set. Cases in flight are then given back.
///
/// In       `own`: of the running program and its dictionary; campaigns of others are left out. tell(progress): called
///          on the calling thread, at each look
/// Faults   an engine that is away is waited for, and named in `waiting_for`
WorkerProgress work(Engine& engine, const campaign::Identity& own, const BeginCampaign& begin,
                    const WorkerSettings& settings, const std::atomic<bool>& stop,
                    const std::function<void(const WorkerProgress&)>& tell);

}  // namespace aeolis::server::cluster
