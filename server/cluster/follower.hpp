// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/cluster.pb.h"
#include "common/result.hpp"
#include "server/archive/shared_archive.hpp"
#include "server/cluster/chosen_runs.hpp"
#include "server/cluster/engine.hpp"
#include "server/cluster/snapshot_fetcher.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace aeolis::server::cluster {

/// How far a follower is.
struct Following {
    std::string origin;                                ///< identity of the archive that is followed
    std::string fault;                                 ///< of the engine; empty: all is well
    std::string publisher;                             ///< the process of the origin that was heard last
    std::uint64_t heard = 0;                           ///< count of what it said then
    double silent_s = 0.0;                             ///< since the origin was heard
    bool lost = false;                                 ///< it has been silent too long, or was never heard
    std::uint64_t behind_items = 0;                    ///< of the origin's runs, as it last told
    double behind_s = 0.0;                             ///< since nothing of them was missing
    std::uint64_t steps = 0, items = 0, repeated = 0;  ///< taken, and passed over, since the start
    std::uint64_t refused = 0;                         ///< messages that are none of the origin's, or not understood
    std::vector<std::string> left_out{};               ///< runs that are not taken further now, and why
    std::string fetching;                              ///< what comes from another server now; empty: nothing
    std::string fetch_fault;                           ///< why what is to be fetched is not; empty: all is well
    std::uint64_t fetched_steps = 0;                   ///< of `steps`
};
/// That in one sentence, for people.
std::string text_of(const Following& following);

/// Has an archive follow the one of an engine that is `wanted` (its identity, or the beginning of it), or the only one
/// that is published there. What was begun once needs no engine. The Error says what is in the way.
Result<void> begin_following(archive::SharedArchive& shared, const EngineAddress& address, const std::string& wanted,
                             std::uint16_t dictionary);

/// Follows another archive: takes its steps from the engine's stream, in the order of each run, and gives them on.
///
/// In       steps of `origin`, of the chosen runs; what is none of its, or leaves something out, is refused, counted
///          and told in a line
/// Out      rows of its own archive, a step a transaction; then `taken`. `run_state`, `clocks`: of the origin's current
///          run, once its beginning is here
/// Faults   an engine or an origin that is away is waited for. Where steps of a run are missing, the stream is read
///          again from its beginning, unless that brought nothing the last time; what still does not follow is fetched
///          from another server where there is one (docs/decisions/0070), else refused. Other runs go on meanwhile
/// Memory   one step and 16 messages, and those of SnapshotFetcher
/// Threads  one of its own, on which all is called. status() from any
class Follower {
  public:
    struct Settings {
        EngineAddress engine;
        std::filesystem::path archive;  ///< the follower's own, which follows another: begin_following()
        std::uint16_t dictionary = 0;
        ChosenRuns runs{};
        SnapshotSource snapshots{};                  ///< of what the engine no longer has
        std::chrono::milliseconds wait{100};         ///< for steps, until the origin's state is looked at
        std::chrono::milliseconds look_every{250};   ///< at the origin's state
        std::chrono::milliseconds lost_after{5000};  ///< chosen: five times what an origin is silent at most
        std::chrono::milliseconds again_after{500};
        std::chrono::milliseconds fetch_again_after{5000};  ///< of a server that refused, or has no more
    };
    struct Parts {
        /// Items that are durable now. What they are is in the archive.
        std::function<void(archive::RunId, archive::Sequence first, archive::Sequence last)> taken;
        std::function<void(v1::RunState)> run_state;
        std::function<void(v1::Clocks)> clocks;
    };

    /// The archive's writer is open in this process, and outlives this.
    static Result<std::unique_ptr<Follower>> start(Settings settings, Parts parts);
    ~Follower();

    Following status() const;

  private:
    class Thread;
    explicit Follower(std::unique_ptr<Thread> thread);
    std::unique_ptr<Thread> thread_;
};

}  // namespace aeolis::server::cluster
