// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/items.pb.h"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/archive/archive.hpp"
#include "server/archive/records.hpp"
#include "server/pipeline/positions.hpp"
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

/// The items that became durable together. Immutable; shared by all who follow the run.
struct PublishedBatch {
    RunId run;
    Sequence first_seq = 0, last_seq = 0;
    bool built = true;            ///< false: items were not wanted; read them from the archive
    std::vector<v1::Item> items;  ///< in order of seq; when built, first_seq … last_seq without gaps
};

using Publish = std::function<void(std::shared_ptr<const PublishedBatch>)>;
/// Compares items flown again with the archive's. The Error names the first that differs.
using Compare = std::function<Result<void>(const PublishedBatch& again)>;

inline constexpr std::chrono::milliseconds commit_interval{10};  ///< design.md: group commits at most every 10 ms
inline constexpr std::size_t commit_items = 8192;                ///< or when this many wait: about 4096 packets
/// Kept while the disk fails; beyond it the run must wait.
inline constexpr std::size_t pending_octets_max = 32U << 20;

/// The latest value received of a channel.
struct LatestValue {
    std::optional<double> value;  ///< none: undefined on board
    Sclk sclk;
    Ert ert;
};

/// Turns the deliveries of one run's links and gateway into numbered items: commits them to the archive, then
/// publishes.
///
/// In       received packets, tones, link changes, command stages; the caller's steady clock
/// Out      rows of the archive; then, in the same order, PublishedBatch to `publish`
/// Rate     any; a commit at most every commit_interval, or when commit_items wait
/// Faults   a failed commit is returned; its items keep their sequence numbers and go with the next commit. When
///          pending_octets_max wait, accept() refuses until a commit succeeds: the caller holds the run
/// Threads  none, no locks and no clock: one owner calls everything; callbacks are called within its calls
class Pipeline {
  public:
    /// Archive and dictionary must outlive this. With `other`, the mission of the dictionary, only its packets are
    /// allowed.
    Pipeline(archive::Archive& archive, const dictionary::Dictionary& dictionary,
             const telemetry::OtherMission* other = nullptr);
    Pipeline(Pipeline&&) noexcept;
    Pipeline& operator=(Pipeline&&) noexcept;
    ~Pipeline();

    void on_publish(Publish publish);
    /// Whether PublishedBatch::items are built: needed only while someone follows. Initially true.
    void want_items(bool wanted);

    /// Begins a run; durable when it returns. One at a time: the last one must have been finished or abandoned.
    Result<RunId> begin(const archive::RunStart& start);

    /// What a run repeats up to the fork: items of another run, which `compare` reads, and what people added to it,
    /// ascending by number. Acts on procedures up to a second behind `until` are taken for acts before it.
    struct Repeated {
        RunId run;
        Compare compare;
        std::vector<archive::Annotation> annotations;
        Ert until;  ///< the time on Earth of the fork
    };
    /// Begins a run that is another up to a fork. Until forked(), its items are compared with those of the other and
    /// stored with its annotations, but not published: they are a past that nobody sees happen.
    Result<RunId> begin(const archive::RunStart& start, Repeated repeated);
    /// Stores what waits; from here on the run is as any. @return its last item; the Error names the first that differs
    Result<Sequence> forked();
    /// Whether an item that was flown again is not what it was.
    bool differs() const;

    /// Resumes a run that was cut off, flown again from its beginning. Items up to `durable` are neither stored nor
    /// published again but compared with the archive by `compare`; after them the run continues as any. One at a time,
    /// as begin().
    /// @param annotations  numbers of items added by people: not produced again, they keep their numbers
    /// @param acts         those of them that were acts on procedures: they are taken again, each at its place
    /// @param positions    those that were acts on positions: they are taken again
    Result<void> resume(RunId run, const archive::RunStart& start, Sequence durable, Compare compare,
                        std::vector<Sequence> annotations = {}, std::vector<archive::ProcedureActRecord> acts = {},
                        std::vector<archive::PositionActRecord> positions = {});
    /// Compares the waiting items. True once all durable items were produced again. A permanent Error when one differs,
    /// or when the run cannot be marked as running again.
    Result<bool> caught_up();
    /// Takes a controller's accepted request; stored with the next commit.
    Result<void> accept(archive::RequestRecord request);

    /// Takes all of it or, with an Error, nothing.
    Result<void> accept(const telemetry::Received& received);
    /// Keeps octets of a link as they came; stored with the next commit.
    Result<void> accept(const telemetry::ReceivedOctets& octets);
    Result<void> accept(const telemetry::ReceivedPacket& packet);
    Result<void> accept(const telemetry::ReceivedTone& tone);
    /// Keeps it as a packet of the station, if the dictionary has that (telemetry/station/station_packets.hpp).
    Result<void> accept(const telemetry::ReceivedCarrier& carrier);
    Result<void> accept(const telemetry::SeenByDoppler& seen);
    Result<void> accept(const telemetry::ReceivedSpectrum& spectrum);
    Result<void> accept(const telemetry::LinkState& link);
    /// Takes a stage and assigns its `seq`.
    Result<void> accept(archive::StageRecord stage);
    /// Reports packets that became stale. Call about once a second of the run.
    Result<void> accept(const telemetry::EarthTime& time);
    /// Adds a person's annotation: to the run in progress, durable with the next commit; to another run, durable and
    /// published when it returns. @return the annotation with its number
    Result<archive::Annotation> annotate(RunId run, archive::Annotation annotation);
    /// What becomes of an act on a procedure.
    struct Acted {
        std::string refused{};                    ///< why it has no place now, in a sentence; empty: it was taken
        archive::ProcedureStatusRecord status{};  ///< the item behind the act
    };
    /// Takes a person's act on a procedure of the run in progress; durable with the next commit, with the status that
    /// follows from it. The Error: nothing can be taken now.
    Result<Acted> act(RunId run, archive::ProcedureActRecord act);
    /// What becomes of an act on a position.
    struct PositionActed {
        std::string refused{};             ///< as Acted
        archive::PositionActRecord act{};  ///< with the board behind it
    };
    /// Takes a person's act on a position of the run in progress; durable with the next commit. The Error: nothing can
    /// be taken now.
    Result<PositionActed> act(RunId run, archive::PositionActRecord act);
    /// Who may do what in the run in progress. From any thread.
    const Positions& positions() const;
    /// Sets the fraction of the recording that is down, 0 … 1; durable with the next commit.
    void relay_progress(double progress);
    /// Sets how many octets of each link of a run are kept as they came; 0: none.
    void keep_raw(std::uint64_t octets);
    /// Sets the counters of links; stored with the next commit.
    void link_totals(std::vector<archive::LinkTotals> links);

    /// Commits when due; `now` starts the next interval. Call at least every commit_interval in real time.
    Result<void> commit_if_due(std::chrono::steady_clock::time_point now);
    /// Commits only when commit_items wait: for a run that nobody watches and that flies as fast as possible.
    Result<void> commit_if_full();
    /// Commits the waiting items at once and publishes them.
    Result<void> commit();
    /// Seals open segments, commits and marks the run finished. May be called again after an error.
    Result<void> finish(const archive::RunEnd& end);
    /// Gives up the run and its waiting items. In the archive it stays `running`; the next open() marks it
    /// `interrupted`.
    void abandon();

    std::optional<RunId> run() const;
    Sequence last_durable() const;
    std::size_t pending_items() const;   ///< including requests, which may arrive alone
    std::size_t pending_octets() const;  ///< of packets and samples waiting for a commit
    archive::RecordingTotals totals() const;
    /// Real-time values only, by ChannelId; none: never received.
    const std::vector<std::optional<LatestValue>>& latest() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace aeolis::pipeline
