// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/archive/archive.hpp"
#include "server/base/bounded_queue.hpp"
#include "server/pipeline/pipeline.hpp"
#include "server/pipeline/refusal_budget.hpp"

#include <atomic>
#include <cstdint>
#include <functional>
#include <future>
#include <map>
#include <optional>
#include <thread>
#include <variant>
#include <vector>

namespace aeolis::server {

/// What a run hands to the archive at once, in the order in which it reached Earth.
struct Delivery {
    using Entry = std::variant<telemetry::ReceivedPacket, telemetry::ReceivedTone, telemetry::LinkState,
                               telemetry::EarthTime, archive::StageRecord, archive::RequestRecord>;
    std::vector<Entry> entries;
    double relay_progress = 0.0;
    std::vector<archive::LinkTotals> links;           ///< empty: as told before
    std::vector<std::function<void()>> when_durable;  ///< called on the pipeline thread, after the commit
    /// Called there, too, after the first attempt at it: with why it is not durable yet, or with nothing when it is.
    /// Who waits for an answer is not kept waiting by a disk.
    std::vector<std::function<void(const std::string& fault)>> answers;

    void add(const telemetry::Received& received);
    /// Once a second of the run: that time goes on.
    void pass(std::uint64_t cycles, Ert now);
};

/// The only writer of the archive: takes deliveries, commits, publishes.
///
/// In       deliveries of one run at a time, through a queue of `deliveries_max`: who delivers waits when it is full
/// Out      what the pipeline publishes, on this thread
/// Faults   a failed commit is told once, and tried again every half second; the run goes on meanwhile, until
///          pipeline::pending_octets_max wait: then it waits too. Nothing is lost. With `Faults::give_up` (one landing
///          without a console) the first failure ends it. Once closing() was said a failing disk has some seconds left,
///          for nobody waits any longer for one that is never mended
class PipelineThread {
  public:
    static constexpr std::size_t audit_waiting_max = 1'000;  ///< ours: some 200 kB
    static constexpr std::size_t deliveries_max = 64;        ///< ours: some 64 × 256 units, about 2 MB

    enum class Faults { hold, give_up };
    PipelineThread(archive::Archive archive, const dictionary::Dictionary& dictionary, Faults faults,
                   pipeline::Publish publish, const telemetry::OtherMission* other = nullptr);
    ~PipelineThread();  ///< takes what is in the queue, then ends

    /// Waits until the run is in the archive.
    Result<archive::RunId> begin(const archive::RunStart& start);
    /// A run that was cut off, flown again from its beginning: what is stored already is compared and not stored again.
    Result<void> resume(archive::CutOffRun& cut, const archive::RunStart& start);
    /// Waits until everything delivered was taken: true when the run has caught up with what is stored; an Error when
    /// it did not come out the same.
    Result<bool> caught_up();
    /// Gives the run up; in the archive it stays as it is.
    void abandon();
    /// Waits while the queue is full. False when writing was given up.
    bool deliver(Delivery delivery);
    /// Waits until everything delivered is durable and the run is marked finished.
    Result<void> finish(const archive::RunEnd& end);
    /// All will end soon: while the disk takes it, everything is still stored; when it fails, whoever waits here gets
    /// the error after some tries, and the run stays as one that was cut off. From any thread.
    void closing() { closing_ = true; }

    /// Stored as soon as the disk takes it; never waits. From any thread. `kept` is told when it is durable, on this
    /// object's thread; while the disk refuses at once, for what was done must still be answered. Of refusals only
    /// those that RefusalBudget takes.
    void audit(archive::AuditRecord record, std::function<void()> kept = {});
    /// False while so much of the audit waits for a failing disk that nothing more may be done that belongs into it.
    bool audit_has_room() const;
    /// Adds to any run what a person says; `done` comes on this thread when it is durable, or with an Error when the
    /// disk refuses it for now. False, and nothing done, when too much waits.
    bool annotate(archive::RunId run, archive::Annotation annotation,
                  std::function<void(Result<archive::Annotation>)> done);

    void want_items(bool wanted) { items_wanted_ = wanted; }
    /// Called on this thread when fault() has changed. Before the first run.
    void on_fault(std::function<void(const std::string& fault)> told) { on_fault_ = std::move(told); }
    /// Given up, or held right now; empty when all is well.
    std::string fault() const;
    /// Nothing more is taken until the disk goes on: the run waits, too.
    bool blocked() const { return blocked_; }

    struct Received {
        std::uint64_t units = 0, octets = 0;
    };
    struct Figures {
        std::uint64_t deliveries = 0, failed_commits = 0, published_batches = 0, published_items = 0;
        std::size_t waiting = 0, audit_waiting = 0;
        std::size_t pending_octets = 0;                 ///< held until the disk takes them
        std::uint64_t commits = 0;                      ///< that had something to make durable
        double commit_s = 0.0, longest_commit_s = 0.0;  ///< of all of them; of one
        std::map<std::string, Received> links;          ///< by name: packets and tones that reached Earth
    };
    Figures figures() const;

  private:
    struct Begin {
        archive::RunStart start;
        std::promise<Result<archive::RunId>> done;
    };
    struct Finish {
        archive::RunEnd end;
        std::promise<Result<void>> done;
    };
    /// Anything else, done on the thread.
    using Action = std::function<void()>;
    using Job = std::variant<Begin, Delivery, Finish, Action>;

    void run();
    /// Done on the thread, and waited for.
    void perform(Action action);
    void take(Delivery& delivery);
    void take_answers(Delivery& delivery);
    /// Repeats `attempt` until it succeeds; false when that is given up.
    bool insist(const std::function<Result<void>()>& attempt);
    /// One attempt at what is due; when it fails, the next after retry_interval.
    void commit_what_is_due();
    void finish(Finish& finish);
    /// Keeps and tells the fault that `result` is, or that it is over.
    bool noted(const Result<void>& result);
    void tell_answers(const std::string& fault);
    bool waits() const;
    Result<void> write_audit();
    /// Whether it is noted; with audit_mutex_ held.
    bool within_budget(archive::AuditRecord& record);
    /// Of all that waits, or of the first so many, which leave.
    void tell_audit_kept(std::optional<std::size_t> written);
    void note_received(const Delivery& delivery);
    void note_commit(std::chrono::steady_clock::duration took);
    /// Of the run and of the audit; the run's when it is due, or at once.
    Result<void> commit(std::optional<std::chrono::steady_clock::time_point> when_due);

    archive::Archive archive_;
    const dictionary::Dictionary& dictionary_;
    pipeline::Pipeline pipeline_;
    Faults faults_;
    BoundedQueue<Job> jobs_{deliveries_max};
    std::atomic<bool> items_wanted_{true}, given_up_{false}, closing_{false}, blocked_{false};
    std::atomic<std::uint64_t> deliveries_{0}, failed_commits_{0}, batches_{0}, items_{0};
    std::atomic<std::size_t> pending_octets_{0};
    mutable std::mutex figures_mutex_;
    std::map<std::string, Received> links_;
    std::uint64_t commits_ = 0;
    double commit_s_ = 0.0, longest_commit_s_ = 0.0;
    mutable std::mutex audit_mutex_;
    std::vector<archive::AuditRecord> audit_;
    RefusalBudget refusals_;
    std::vector<std::function<void()>> audit_kept_;    ///< one a record; empty: told, or nobody wants to know
    std::vector<std::function<void()>> when_durable_;  ///< of what waits
    std::vector<std::function<void(const std::string& fault)>> answers_;  ///< of what waits for the first attempt
    std::chrono::steady_clock::time_point next_attempt_{};
    std::function<void(const std::string&)> on_fault_;
    mutable std::mutex fault_mutex_;
    std::string fault_;
    std::thread thread_;
};

}  // namespace aeolis::server
