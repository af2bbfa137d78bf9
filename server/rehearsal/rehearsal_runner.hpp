// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/kept.pb.h"
#include "aeolis/v1/plan.pb.h"
#include "aeolis/v1/run.pb.h"
#include "aeolis/v1/scenario.pb.h"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/archive/records.hpp"
#include "server/instruction/plan_conductor.hpp"
#include "server/pipeline/pipeline_thread.hpp"
#include "server/rehearsal/client_ids.hpp"
#include "server/rehearsal/companion.hpp"
#include "server/rehearsal/run_order.hpp"
#include "simulation/scenario.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace aeolis::server {

class Rehearsal;

/// An instructor's plan for a run: as it was given, and as it was read.
struct PlannedInjects {
    v1::InstructorPlan given;
    instruction::InjectPlan plan;
};

/// Flies one rehearsal in its own thread at the ordered pace and archives all that reaches Earth.
///
/// In       orders, from any thread: carried out between two cycles, in the order received
/// Out      deliveries to the pipeline; state on every change and once a second, clocks ten times a second
/// Pace     1 … 1000 × real time, 0: as fast as possible. When the machine or the disk cannot keep up, the run is
///          slower, nothing is skipped, and `attained_pace` reports it
/// Tones    when the scenario leaves it open, decoded from a waveform up to a pace of signal_pace_max, else drawn from
///          the symbol error. The pace at the start decides for the whole run, so that no tone is lost or doubled when
///          the pace changes (decision 0019)
/// Ground   unless the scenario says otherwise, ground keeps a flight of its own beside a run that begins at a pace of 1
///          to companion_pace_max. That, too, holds for the whole run (decision 0063)
/// Cut off  a run ended by a crash is flown again as fast as possible with the same seed, clock, and requests at the
///          same cycles. Each item is compared with the archive; after the last stored one the run continues as normal.
///          When an item differs, the run stays interrupted and on_begun gets the Error (decision 0021)
/// Fork     another run is flown again up to an instant, in the same way, and stored as a new one; from there on it goes
///          on by itself. When an item differs, the new run ends there and on_begun gets the Error (decision 0060)
/// Jump     flown to a time as fast as possible and held there. It is kept as a request is, as it begins and as it
///          ends, so that a score knows of it. A run that is continued or forked within one ends it there, and a
///          continued one holds
/// Plan     an instructor's injects are carried out at the cycles at which they are due, and kept as faults by hand are:
///          a run that is flown again has each once. Ground's own flight is told of none
/// Faults   a run that cannot begin in the archive is not flown: on_begun gets the Error
class RehearsalRunner {
  public:
    static constexpr double pace_max = 1000.0;
    /// Chosen: a quarter of the pace measured as sustainable on a shared core, headless (docs/tones.md).
    static constexpr double signal_pace_max = 50.0;
    static constexpr std::size_t requests_max = 64;  ///< chosen: commands waiting for the next cycle
    static constexpr std::size_t faults_max = 100;   ///< chosen: injected into one run
    static constexpr std::size_t notes_max = 1'000;  ///< chosen: by instructors in one run

    /// Called on the rehearsal's thread.
    struct Callbacks {
        std::function<void(Result<v1::RunState>)> on_begun;  ///< once; after an Error no other callback follows
        std::function<void(v1::RunState)> on_state;
        std::function<void(v1::Clocks)> on_clocks;
        /// A command that changes the timeline had no effect, and this is durable: the waiting commands were analysed
        /// with it. On the pipeline's thread.
        std::function<void()> on_timeline_moved;
        MakeCompanion companion{};  ///< none: ground keeps no flight beside the run
    };

    /// Whether the tones of a run that begins at `pace` are decoded from samples.
    static bool from_samples(const simulation::Radio& radio, double pace) {
        return radio.tones_from_samples.value_or(pace > 0.0 && pace <= signal_pace_max);
    }

    /// Chosen. A run takes 1.4 times the processor with a flight of ground's beside it (docs/shadow.md).
    static constexpr double companion_pace_max = 100.0;

    /// Dictionary and pipeline must outlive this.
    RehearsalRunner(simulation::Scenario scenario, std::uint64_t seed, double pace,
                    const dictionary::Dictionary& dictionary, PipelineThread& pipeline, Callbacks callbacks,
                    std::optional<PlannedInjects> plan = {});
    /// A run that begins as another: one that was cut off, to be continued, or with `fork` a new one.
    struct Again {
        archive::FlownRun run;
        std::optional<archive::ForkPoint> fork{};
        bool paused = false;  ///< at the fork
    };
    /// @param scenario  the one in the run's row
    RehearsalRunner(simulation::Scenario scenario, Again again, double pace, const dictionary::Dictionary& dictionary,
                    PipelineThread& pipeline, Callbacks callbacks);
    ~RehearsalRunner();  ///< leaves the run, to be continued, and waits for its thread

    /// Takes an order. The Error says why an intervention is refused; commands are refused in their replies. Replies to
    /// accepted commands are given on the pipeline's thread once their stages are durable, those of a dry run at once.
    Result<void> order(RunOrder order);
    bool over() const;            ///< the thread has ended its work
    std::size_t waiting() const;  ///< commands and command files waiting for the next cycle
    /// Accepted commands in the queue, and those at the uplink not yet radiated. As of the last delivery.
    std::size_t queued() const { return queued_; }
    std::size_t at_uplink() const { return at_uplink_; }
    /// The name of the command with this number; none: no such number yet.
    std::optional<std::string> name_of_command(std::uint64_t number) const;
    /// The requests that do not carry the id of an accepted command; only these are sent.
    std::vector<v1::CommandRequest> unknown(const std::vector<v1::CommandRequest>& requests) const;

  private:
    using Clock = std::chrono::steady_clock;
    static constexpr double no_jump = -std::numeric_limits<double>::infinity();

    void run();
    /// Begins to follow the plan that the run was given, or that it was stored with.
    Result<void> follow_plan(const Rehearsal& rehearsal);
    /// Carries out the injects that are due after the last cycle.
    void conduct(Rehearsal& rehearsal);
    Result<void> begin(Rehearsal& rehearsal);
    /// Flies again the part of the run that is in the archive.
    Result<void> catch_up(Rehearsal& rehearsal);
    /// Flies the other run again up to the fork, and stores it as this one.
    Result<void> fork(Rehearsal& rehearsal);
    /// Repeats the requests that were taken before this cycle, from `next` on.
    Result<void> repeat_due(Rehearsal& rehearsal, std::size_t& next);
    bool stop_wanted() const;
    void fly(Rehearsal& rehearsal);
    /// Takes the orders since the last call; waits for one until `due`.
    std::vector<RunOrder> take_orders(std::optional<Clock::time_point> due);
    /// Carries out orders. True when pause, pace or jump changed.
    bool carry_out(Rehearsal& rehearsal, const std::vector<RunOrder>& orders);
    void carry_out(Rehearsal& rehearsal, const PauseRun& order);
    void carry_out(Rehearsal& rehearsal, const PaceRun& order);
    void carry_out(Rehearsal& rehearsal, const JumpRun& order);
    void carry_out(Rehearsal& rehearsal, const StopRun& order);
    void carry_out(Rehearsal& rehearsal, const LeaveRun& order);
    void carry_out(Rehearsal& rehearsal, const InterveneRun& order);
    void carry_out(Rehearsal& rehearsal, const SendCommands& order);
    void carry_out(Rehearsal& rehearsal, const commands::TimelineVerdict& verdict);
    /// Keeps the request in the archive, with the cycle before which it was carried out.
    void keep(const Rehearsal& rehearsal, const v1::KeptRequest& request);
    /// Tells ground's own flight of a request, unless it is an instructor's.
    void tell_companion(const Rehearsal& rehearsal, const v1::KeptRequest& request);
    /// Why the order is refused; empty: accepted. Call with mutex_ held.
    std::string refusal_of(const RunOrder& order) const;
    std::size_t commands_waiting() const;  ///< call with mutex_ held
    /// Where a jump ends that goes on or is ordered. Call with mutex_ held.
    std::optional<double> jump_under_way() const;
    /// Whether all were accepted before, by their clients' ids. Call with mutex_ held.
    bool knows_all(const std::vector<v1::CommandRequest>& requests) const;
    void count_pace_from(const Rehearsal& rehearsal, Clock::time_point now);
    /// Ends a jump here, if there is one, and keeps where. @return whether there was one
    bool end_jump(const Rehearsal& rehearsal);
    void keep_jump(const Rehearsal& rehearsal, double to_e_s, bool begins);
    /// When the next cycle is due; always when there is no pace.
    Clock::time_point next_cycle_due(const Rehearsal& rehearsal, Clock::time_point now) const;
    void finish(Rehearsal& rehearsal);
    void leave(const Rehearsal& rehearsal);
    /// What ground's own flight makes of the last cycle.
    void accompany(const telemetry::Received& received, const Rehearsal& rehearsal);
    /// Repeats a request stored with this run.
    bool repeat(Rehearsal& rehearsal, const std::string& request);
    /// For each command the reply where it repeats an earlier one by its client's id, else none.
    std::vector<std::optional<v1::CommandReply>> repeated(const SendCommands& order) const;
    v1::CommandReply submit(Rehearsal& rehearsal, const v1::CommandRequest& request, const SendCommands& order);
    /// Checks commands. @return the replies of refused commands, or of all in a dry run; empty: each may be accepted
    static std::vector<v1::CommandReply> look_at(Rehearsal& rehearsal, const SendCommands& order);
    /// Flies a cycle and collects what ground then has.
    void step(Rehearsal& rehearsal);
    void take_stages(Rehearsal& rehearsal);
    bool deliver(const Rehearsal& rehearsal, Clock::time_point now);
    void tell(const Rehearsal& rehearsal, Clock::time_point now, bool changed);
    v1::RunState state(const Rehearsal& rehearsal) const;
    archive::Outcome outcome(const Rehearsal& rehearsal) const;  ///< `stopped` when it was stopped early

    simulation::Scenario scenario_;
    std::uint64_t seed_;
    std::optional<Again> again_;
    const dictionary::Dictionary& dictionary_;
    PipelineThread& pipeline_;
    Callbacks callbacks_;

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<RunOrder> orders_;                         ///< under mutex_; for the next cycle
    bool stop_ = false, over_ = false;                     ///< under mutex_
    std::size_t faults_taken_ = 0, notes_taken_ = 0;       ///< under mutex_; since this runner began
    std::map<std::uint64_t, std::string> names_;           ///< under mutex_; of the run's commands, by number
    ClientIds client_ids_;                                 ///< under mutex_
    std::optional<PlannedInjects> plan_;                   ///< of a run that is new
    std::optional<instruction::PlanConductor> conductor_;  ///< under mutex_; none: the run has no plan
    std::set<std::string> settled_in_archive_;             ///< injects that a run flown again repeats from its requests

    std::atomic<std::size_t> queued_{0}, at_uplink_{0};
    std::atomic<double> now_e_s_{-std::numeric_limits<double>::infinity()};  ///< of the last cycle, by the vehicle
    std::atomic<double> jumps_to_e_s_{no_jump};

    // Used by the rehearsal's thread only.
    archive::RunId run_id_;
    archive::RunStart start_;
    std::unique_ptr<Companion> companion_;
    Delivery delivery_;
    bool timeline_moved_ = false;  ///< by a stage in delivery_
    bool paused_ = false, finished_ = false, stopped_ = false, left_ = false, archive_gave_up_ = false;
    double pace_ = 1.0, attained_pace_ = 0.0;
    double jumps_from_e_s_ = 0.0;
    Clock::time_point pace_since_{};  ///< start of counting the pace, at cycle pace_since_cycle_
    std::uint64_t pace_since_cycle_ = 0;
    std::string digest_;
    Clock::time_point delivered_{}, clocks_told_{}, state_told_{}, links_told_{};
    std::uint64_t cycles_told_ = 0;

    std::thread thread_;
};

}  // namespace aeolis::server
