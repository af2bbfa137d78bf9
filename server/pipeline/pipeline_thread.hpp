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

/// Entries that a run hands to the archive together, in the order in which they reached Earth.
struct Delivery {
    using Entry =
        std::variant<telemetry::ReceivedOctets, telemetry::ReceivedPacket, telemetry::ReceivedTone,
                     telemetry::ReceivedCarrier, telemetry::SeenByDoppler, telemetry::ReceivedSpectrum,
                     telemetry::LinkState, telemetry::EarthTime, archive::StageRecord, archive::RequestRecord>;
    std::vector<Entry> entries;
    double relay_progress = 0.0;
    std::vector<archive::LinkTotals> links;           ///< empty: unchanged
    std::vector<std::function<void()>> when_durable;  ///< called on the pipeline thread, after the commit
    /// Called on the pipeline thread after the first commit attempt: with the fault, or empty when durable. A failing
    /// disk thus does not delay answers.
    std::vector<std::function<void(const std::string& fault)>> answers;

    void add(telemetry::Received&& received);
    /// Adds the time on Earth, once a second of the run.
    void pass(std::uint64_t cycles, Ert now);
};

/// The only writer of the archive: takes deliveries, commits, publishes.
///
/// In       deliveries of one run at a time, through a queue of `deliveries_max`; deliver() waits when it is full
/// Out      what the pipeline publishes, on this thread
/// Faults   a failed commit is reported once and retried every half second; the run proceeds until
///          pipeline::pending_octets_max wait, then it waits too. Nothing is lost. With `Faults::give_up` (a landing
///          without a console) the first failure ends it. After closing() a failing disk gets a few more seconds:
///          nobody will mend it
class PipelineThread {
  public:
    static constexpr std::size_t audit_waiting_max = 1'000;  ///< chosen: about 200 kB
    static constexpr std::size_t deliveries_max = 64;        ///< chosen: about 64 × 256 packets, 2 MB

    enum class Faults { hold, give_up };
    PipelineThread(archive::Archive archive, const dictionary::Dictionary& dictionary, Faults faults,
                   pipeline::Publish publish, const telemetry::OtherMission* other = nullptr);
    ~PipelineThread();  ///< drains the queue, then ends

    /// Begins a run; waits until it is in the archive.
    Result<archive::RunId> begin(const archive::RunStart& start);
    /// Begins a run that is another up to a fork: see Pipeline::begin.
    Result<archive::RunId> begin(const archive::RunStart& start, archive::RunId of, Ert until);
    /// Waits until all deliveries were taken and stored. An Error when what was flown again differs.
    /// @return the number of the last item
    Result<archive::Sequence> forked();
    /// Whether something of it differs, as of the last commit.
    bool differs() const { return differs_; }
    /// Resumes a run that was cut off, flown again from its beginning: stored items are compared and not stored again.
    Result<void> resume(archive::FlownRun& cut, const archive::RunStart& start);
    /// Waits until all deliveries were taken. True when the run has caught up with the stored items; an Error when it
    /// differs from them.
    Result<bool> caught_up();
    /// Gives the run up; in the archive it stays unchanged.
    void abandon();
    /// Makes what was delivered durable, as far as the disk takes it, and abandons the run, which stays interrupted.
    void leave();
    /// Waits while the queue is full. False when writing was given up.
    bool deliver(Delivery delivery);
    /// Waits until all deliveries are durable and the run is marked finished.
    Result<void> finish(const archive::RunEnd& end);
    /// Packets of the run finished last that were not decoded.
    std::uint64_t not_decoded() const { return not_decoded_; }
    /// Announces the end of the program. A working disk still stores everything; when it fails, callers that wait get
    /// the Error after some tries, and the run stays interrupted. From any thread.
    void closing() { closing_ = true; }

    /// Queues an audit record; never waits. From any thread. Calls `kept` on this object's thread once the record is
    /// durable. While the disk refuses, or when the record is not stored, calls it at once on the caller's: the action
    /// was carried out and must be answered. Of refusals only those within RefusalBudget are stored. Beyond 2 *
    /// audit_waiting_max a record is lost and logged.
    void audit(archive::AuditRecord record, std::function<void()> kept = {});
    /// Whether audited actions may still be carried out: false while too many records wait for a failing disk.
    bool audit_has_room() const;
    struct Annotated {
        archive::Annotation annotation;
        std::string not_stored_yet{};  ///< taken, but the disk refuses it for now; empty: durable
    };
    /// Adds a person's annotation to any run. Calls `done` on this thread once it is durable or the disk refuses it for
    /// now, or with an Error: nothing was added. False, and nothing done, when too much waits.
    bool annotate(archive::RunId run, archive::Annotation annotation, std::function<void(Result<Annotated>)> done);

    struct Acted {
        pipeline::Pipeline::Acted outcome;
        std::string not_stored_yet{};  ///< taken, but the disk refuses it for now; empty: durable
    };
    /// Takes a person's act on a procedure of the run in progress. Calls `done` on this thread once it is durable, when
    /// the disk refuses it for now, when it has no place, or with an Error: nothing can be taken. False, and nothing
    /// done, when too much waits.
    bool act(archive::RunId run, archive::ProcedureActRecord act, std::function<void(Result<Acted>)> done);
    struct PositionActed {
        pipeline::Pipeline::PositionActed outcome;
        std::string not_stored_yet{};  ///< as Acted
    };
    /// Takes a person's act on a position of the run in progress, as an act on a procedure.
    bool act(archive::RunId run, archive::PositionActRecord act, std::function<void(Result<PositionActed>)> done);
    /// Who may do what in the run in progress. From any thread.
    const pipeline::Positions& positions() const { return pipeline_.positions(); }

    /// Stores a forecast. Calls `done` on this thread with its number once it is durable, or with an Error. False, and
    /// nothing done, when too much waits.
    bool keep_forecast(archive::ForecastRecord forecast, std::function<void(Result<std::uint64_t>)> done);
    /// Saves or removes a layout. Calls `done` on this thread once that is durable, or with an Error: nothing was
    /// changed. False, and nothing done, when too much waits.
    bool change_layout(archive::LayoutChange change, std::function<void(Result<archive::LayoutOutcome>)> done);

    /// Removes a run that is over: at once for readers, and its rows piece by piece, in a tenth of this thread's time.
    /// Calls `done` on this thread once readers no longer find it, or with an Error. False, and nothing done, when too
    /// much waits.
    bool prune(archive::RunId run, archive::AuditRecord by, std::function<void(Result<void>)> done);

    void want_items(bool wanted) { items_wanted_ = wanted; }
    /// Sets how many octets of each link of a run are kept as they came. Call before the first run.
    void keep_raw(std::uint64_t octets) { pipeline_.keep_raw(octets); }
    /// Sets the callback, called on this thread, for each change of fault(). Call before the first run.
    void on_fault(std::function<void(const std::string& fault)> told) { on_fault_ = std::move(told); }
    /// Sets the callback, called on this thread, for each durable entry that is the audit's newest. Call before the
    /// first run.
    void on_audited(std::function<void(const archive::AuditHead& head)> told) { on_audited_ = std::move(told); }
    /// Why nothing is stored, now or for good; empty when all is well.
    std::string fault() const;
    /// Whether nothing more is taken until the disk recovers; the run then waits.
    bool blocked() const { return blocked_; }

    struct Received {
        std::uint64_t items = 0, octets = 0;
    };
    struct Figures {
        std::uint64_t deliveries = 0, failed_commits = 0, published_batches = 0, published_items = 0;
        std::size_t waiting = 0, audit_waiting = 0;
        std::size_t pending_octets = 0;                     ///< kept until the disk takes them
        std::uintmax_t archive_octets = 0, log_octets = 0;  ///< sizes of the file and of SQLite's write-ahead log
        std::uint64_t commits = 0;                          ///< that made something durable
        double commit_s = 0.0, longest_commit_s = 0.0;      ///< of all commits; of one
        std::map<std::string, Received> links;              ///< by name: packets and tones that reached Earth
        std::map<std::string, archive::LinkTotals> totals;  ///< by link: of the run, as last reported
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
    /// Any other action, run on the thread.
    using Action = std::function<void()>;
    using Job = std::variant<Begin, Delivery, Finish, Action>;

    void run();
    /// Runs an action on the thread and waits for it.
    void perform(Action action);
    void take(Delivery& delivery);
    void take_answers(Delivery& delivery);
    /// Repeats `attempt` until it succeeds; false when it is given up.
    bool retry_until_stored(const std::function<Result<void>()>& attempt);
    /// Attempts once to commit what is due; after a failure the next attempt is after retry_interval.
    void commit_what_is_due();
    void finish(Finish& finish);
    template <typename Answer, typename Record>
    bool push_act(archive::RunId run, Record act, std::function<void(Result<Answer>)> done);
    /// Sets the fault from `result`, or clears it, and reports the change.
    bool noted(const Result<void>& result);
    void tell_answers(const std::string& fault);
    bool waits() const;
    Result<void> write_audit();
    /// Removes a piece of what pruned runs left, when it is time for one.
    void remove_pruned();
    /// Reports the newest entry of the audit, unless it is the one reported last.
    void tell_audit_head();
    /// Whether the budget admits the record. Call with audit_mutex_ held.
    bool within_budget(archive::AuditRecord& record);
    /// Calls and removes all waiting callbacks or, with `written`, those of the first records. These records leave the
    /// queue.
    void tell_audit_kept(std::optional<std::size_t> written);
    void note_received(const Delivery& delivery);
    void note_commit(std::chrono::steady_clock::duration took);
    /// Commits the run, when due or at once, and then the audit.
    Result<void> commit(std::optional<std::chrono::steady_clock::time_point> when_due);

    archive::Archive archive_;
    const dictionary::Dictionary& dictionary_;
    pipeline::Pipeline pipeline_;
    Faults faults_;
    BoundedQueue<Job> jobs_{deliveries_max};
    std::atomic<bool> items_wanted_{true}, given_up_{false}, closing_{false}, blocked_{false};
    std::atomic<std::uint64_t> deliveries_{0}, failed_commits_{0}, batches_{0}, items_{0}, not_decoded_{0};
    std::atomic<std::size_t> pending_octets_{0};
    std::atomic<bool> differs_{false};
    mutable std::mutex figures_mutex_;
    std::map<std::string, Received> links_;
    std::map<std::string, archive::LinkTotals> totals_;
    std::uint64_t commits_ = 0;
    double commit_s_ = 0.0, longest_commit_s_ = 0.0;
    mutable std::mutex audit_mutex_;
    std::vector<archive::AuditRecord> audit_;
    RefusalBudget refusals_;
    std::vector<std::function<void()>> audit_kept_;    ///< one per record; empty: called, or none wanted
    std::vector<std::function<void()>> when_durable_;  ///< for waiting deliveries
    /// For deliveries waiting for the first attempt.
    std::vector<std::function<void(const std::string& fault)>> answers_;
    std::chrono::steady_clock::time_point next_attempt_{};
    bool pruning_ = true;  ///< rows of pruned runs may be left: the program may have ended before all were removed
    std::chrono::steady_clock::time_point next_piece_{};
    std::function<void(const std::string&)> on_fault_;
    std::function<void(const archive::AuditHead&)> on_audited_;
    archive::AuditHead audit_head_;  ///< the one reported last
    mutable std::mutex fault_mutex_;
    std::string fault_;
    std::thread thread_;
};

}  // namespace aeolis::server
