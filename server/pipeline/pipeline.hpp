// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/items.pb.h"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/archive/archive.hpp"
#include "server/archive/records.hpp"
#include "telemetry/decommutator.hpp"
#include "telemetry/other_mission.hpp"
#include "telemetry/station/received.hpp"

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace aeolis::pipeline {

using archive::RunId;
using archive::Sequence;

/// What became durable together. Immutable and shared by all who follow the run.
struct PublishedBatch {
    RunId run;
    Sequence first_seq = 0, last_seq = 0;
    bool built = true;            ///< false: nobody wanted items; who does now reads them from the archive
    std::vector<v1::Item> items;  ///< in order of seq, first_seq … last_seq without a gap when built
};

/// Sees each packet when it was decoded, before it is durable: for the command path, which must match answers.
using Observer = std::function<void(const telemetry::Decoded& decoded, std::span<const std::uint8_t> octets,
                                    archive::Source source, Ert ert)>;
using Publish = std::function<void(std::shared_ptr<const PublishedBatch>)>;
/// Whether what is flown again is what the archive has of it; an Error names the first item that is not.
using Compare = std::function<Result<void>(const PublishedBatch& again)>;

inline constexpr std::chrono::milliseconds commit_interval{10};  ///< design.md: group commits at most every 10 ms
inline constexpr std::size_t commit_items = 8192;                ///< or when so many wait: some 4096 units
inline constexpr std::size_t pending_octets_max = 32U << 20;     ///< held while the disk fails; then the run must wait

/// What has come of a channel.
struct LatestValue {
    std::optional<double> value;  ///< none: undefined on board
    Sclk sclk;
    Ert ert;
};

/// Turns what one run's links and gateway deliver into numbered items: commits them to the archive, then publishes.
///
/// In       received packets, tones, link changes, command stages; the caller's steady clock
/// Out      rows of the archive; then, in the same order, PublishedBatch to `publish`
/// Rate     whatever comes; a commit at most every commit_interval, or when commit_items wait
/// Faults   a failed commit is returned; all that waits is kept, with its sequence numbers, and goes with the next
///          commit. When pending_octets_max wait, accept() refuses until a commit succeeds: the caller holds the run.
/// Threads  none, no locks and no clock: one owner calls everything, callbacks come from within its calls
class Pipeline {
  public:
    /// Archive and dictionary must outlive this. With `other`, whose dictionary it then is, only packets of that
    /// mission may come.
    Pipeline(archive::Archive& archive, const dictionary::Dictionary& dictionary,
             const telemetry::OtherMission* other = nullptr);
    Pipeline(Pipeline&&) noexcept;
    Pipeline& operator=(Pipeline&&) noexcept;
    ~Pipeline();

    void on_publish(Publish publish);
    void on_decoded(Observer observer);
    /// Whether PublishedBatch::items are built: only needed while someone follows. On at the start.
    void want_items(bool wanted);

    /// A new run, durable when it returns. One at a time: the last one must have been finished or abandoned.
    Result<RunId> begin(const archive::RunStart& start);

    /// A run that was cut off is flown again from its beginning: items up to `durable` are neither stored nor published
    /// again but held against the archive by `compare`. After the last of them it goes on as any run. One at a time, as
    /// begin().
    /// @param annotations  numbers of what people added: it does not come again, and keeps its numbers
    Result<void> resume(RunId run, const archive::RunStart& start, Sequence durable, Compare compare,
                        std::vector<Sequence> annotations = {});
    /// Compares what waits. True once all that was durable has come again; an Error for good when something else came,
    /// or the run cannot be marked as running again.
    Result<bool> caught_up();
    /// A controller's request that was taken: stored with the next commit.
    Result<void> accept(archive::RequestRecord request);

    /// All of it or, with an Error, nothing.
    Result<void> accept(const telemetry::Received& received);
    Result<void> accept(const telemetry::ReceivedPacket& packet);
    Result<void> accept(const telemetry::ReceivedTone& tone);
    Result<void> accept(const telemetry::LinkState& link);
    /// `stage.seq` is given here.
    Result<void> accept(archive::StageRecord stage);
    /// Once a second of the run or so: tells what has become stale.
    Result<void> accept(const telemetry::EarthTime& time);
    /// What a person adds to any run: to the one that goes on, durable with the next commit; to another, durable and
    /// published when it returns. @return with its number
    Result<archive::Annotation> annotate(RunId run, archive::Annotation annotation);
    /// 0 … 1 of the recording that has come down; durable with the next commit.
    void relay_progress(double progress);
    /// Counters of links, stored with the next commit.
    void link_totals(std::vector<archive::LinkTotals> links);

    /// Commits when due; `now` starts the interval of the next. Call it at least every commit_interval in real time.
    Result<void> commit_if_due(std::chrono::steady_clock::time_point now);
    /// Commits only when commit_items wait: for a run that nobody watches, as fast as it goes.
    Result<void> commit_if_full();
    /// Commits what waits, at once, and publishes it.
    Result<void> commit();
    /// Seals open segments, commits and marks the run finished. May be called again after an error.
    Result<void> finish(const archive::RunEnd& end);
    /// Gives up the run and what waits of it: in the archive it stays `running`, and is `interrupted` at the next open.
    void abandon();

    std::optional<RunId> run() const;
    Sequence last_durable() const;
    std::size_t pending_items() const;   ///< and requests, which may come while nothing else does
    std::size_t pending_octets() const;  ///< of packets and samples that wait for a commit
    archive::RecordingTotals totals() const;
    /// In real time only, by ChannelId; none: never received.
    const std::vector<std::optional<LatestValue>>& latest() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace aeolis::pipeline
