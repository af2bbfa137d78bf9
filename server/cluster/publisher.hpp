// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "common/result.hpp"
#include "server/cluster/engine.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace aeolis::server::cluster {

/// How far an archive is published.
struct Publishing {
    std::string fault;                               ///< why nothing is published now; empty: all is well
    std::uint64_t waiting_items = 0;                 ///< committed and not acknowledged, of the runs that are looked at
    double waiting_s = 0.0;                          ///< since all was acknowledged
    std::uint64_t steps = 0, octets = 0, items = 0;  ///< acknowledged since the start
    std::uint64_t again = 0;                         ///< runs that were looked up in the engine anew
    std::vector<std::string> left_out{};             ///< runs that are not published, and why
};

/// That in one sentence, for people.
std::string text_of(const Publishing& publishing);

/// Publishes what an archive has committed, run by run, to an engine's durable stream (docs/decisions/0042).
///
/// In       the archive's file, read after its commits; never the pipeline's memory
/// Out      steps of rows, each behind the one before it in its subject, or refused by the engine. How far they are
///          acknowledged is kept in the archive, at most once a second
/// Memory   one step. What waits, waits in the archive
/// Faults   an engine that is slow, full, away or replaced is tried again without end and told in status(); nobody
///          waits for it. Of an engine without its streams all runs are published anew, from the archive
/// Threads  one of its own, which alone uses the engine. status(), run_state() and clocks() from any
class Publisher {
  public:
    struct Settings {
        EngineAddress engine;
        std::filesystem::path archive;
        std::uint16_t dictionary = 0;
        std::chrono::milliseconds look_every{10};    ///< as often as the archive commits at most
        std::chrono::milliseconds tell_every{1000};  ///< that this origin lives, when nothing else is to be told
        std::chrono::milliseconds again_after{500};  ///< when the engine refused or is away
    };
    /// The archive's writer is open in this process, and outlives this.
    explicit Publisher(Settings settings);
    ~Publisher();

    void run_state(const v1::RunState& state);
    void clocks(const v1::Clocks& clocks);
    Publishing status() const;
    /// How long ago this origin told of itself for the `count`-th time; none: another process did, or longer ago than
    /// `told_kept`.
    std::optional<std::chrono::milliseconds> age_of(const std::string& publisher, std::uint64_t count) const;
    static constexpr std::chrono::seconds told_kept{30};

  private:
    class Thread;
    std::unique_ptr<Thread> thread_;
};

}  // namespace aeolis::server::cluster
