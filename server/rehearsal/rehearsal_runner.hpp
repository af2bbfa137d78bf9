// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "aeolis/v1/scenario.pb.h"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/pipeline/pipeline_thread.hpp"
#include "server/rehearsal/run_order.hpp"
#include "simulation/scenario.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace aeolis::server {

class Rehearsal;

/// Flies one rehearsal in its own thread, at the pace asked for, and hands what reaches Earth to the archive.
///
/// In       orders, from any thread: carried out between two cycles, in the order in which they came
/// Out      deliveries to the pipeline; state on every change and once a second, clocks ten times a second
/// Pace     1 … 1000 × real time, 0: as fast as it goes. When the machine or the disk cannot keep up, the run is
///          slower, nothing is skipped, and `attained_pace` says so.
/// Tones    where the scenario leaves it open they are decoded from a waveform up to a pace of signal_pace_max, else
///          drawn from the symbol error: the pace asked for at the start decides, for the whole run, so that none is
///          lost or doubled when the pace changes (decision 0019)
/// Cut off  a run that a crash ended is flown again with the same seed, clock and requests at the same cycles, as fast
///          as it goes; each item is held against the archive, and after the last that is stored the run goes on as if
///          nothing had been. When one is not what it was, the run stays interrupted and on_begun gets the error
///          (decision 0021)
/// Faults   a run that cannot be begun in the archive is not flown: on_begun gets the error
class RehearsalRunner {
  public:
    static constexpr double pace_max = 1000.0;
    /// A quarter of what a shared core was measured to sustain, headless (docs/tones.md). Ours
    static constexpr double signal_pace_max = 50.0;
    static constexpr std::size_t requests_max = 64;  ///< commands waiting for the next cycle; ours
    static constexpr std::size_t faults_max = 100;   ///< injected into one run; ours
    static constexpr std::size_t notes_max = 1'000;  ///< of instructors in one run; ours

    /// Called on the rehearsal's thread.
    struct Callbacks {
        std::function<void(Result<v1::RunState>)> on_begun;  ///< once; after an error nothing else comes
        std::function<void(v1::RunState)> on_state;
        std::function<void(v1::Clocks)> on_clocks;
        /// A command that changes the timeline has come to nothing, and that is durable: what still waits was analysed
        /// with it. On the pipeline's thread
        std::function<void()> on_timeline_moved;
    };

    /// Whether tones of a run that begins at `pace` come from samples.
    static bool from_samples(const simulation::Radio& radio, double pace) {
        return radio.tones_from_samples.value_or(pace > 0.0 && pace <= signal_pace_max);
    }

    /// Dictionary and pipeline must outlive this.
    RehearsalRunner(simulation::Scenario scenario, std::uint64_t seed, double pace,
                    const dictionary::Dictionary& dictionary, PipelineThread& pipeline, Callbacks callbacks);
    /// Goes on with a run that was cut off; `scenario` is the one in its row.
    RehearsalRunner(simulation::Scenario scenario, archive::CutOffRun cut, double pace,
                    const dictionary::Dictionary& dictionary, PipelineThread& pipeline, Callbacks callbacks);
    ~RehearsalRunner();  ///< stops the run and waits for its thread

    /// An Error says why an intervention is not taken. Commands that are not taken are refused by their replies; the
    /// replies to others come on the pipeline's thread once their stages are durable, those of a dry run at once.
    Result<void> order(RunOrder order);
    bool over() const;            ///< the thread has nothing more to do
    std::size_t waiting() const;  ///< commands, and command files, for the next cycle
    /// Of those that were taken: what has not left the queue, and what the uplink has and has not radiated. As of the
    /// last delivery.
    std::size_t queued() const { return queued_; }
    std::size_t at_uplink() const { return at_uplink_; }
    /// Of the command with this number; none: there is none yet.
    std::optional<std::string> name_of_command(std::uint64_t number) const;

  private:
    using Clock = std::chrono::steady_clock;

    void run();
    Result<void> begin(Rehearsal& rehearsal);
    /// Flies again what the archive has of the run.
    Result<void> catch_up(Rehearsal& rehearsal);
    bool stop_wanted() const;
    void fly(Rehearsal& rehearsal);
    /// Orders since the last call; waits for one until `due`.
    std::vector<RunOrder> take_orders(std::optional<Clock::time_point> due);
    /// Whether pause or pace are others than before.
    bool carry_out(Rehearsal& rehearsal, const std::vector<RunOrder>& orders);
    void carry_out(Rehearsal& rehearsal, const PauseRun& order);
    void carry_out(Rehearsal& rehearsal, const PaceRun& order);
    void carry_out(Rehearsal& rehearsal, const StopRun& order);
    void carry_out(Rehearsal& rehearsal, const Intervene& order);
    void carry_out(Rehearsal& rehearsal, const SendCommands& order);
    void carry_out(Rehearsal& rehearsal, const commands::TimelineVerdict& verdict);
    /// Into the archive, with the cycle before which it was carried out.
    void keep(const Rehearsal& rehearsal, const v1::KeptRequest& request);
    /// Why the order is not taken; empty: it is. Under mutex_.
    std::string refusal_of(const RunOrder& order) const;
    std::size_t commands_waiting() const;  ///< under mutex_
    void count_pace_from(const Rehearsal& rehearsal, Clock::time_point now);
    /// When the next cycle is due; without pace it always is.
    Clock::time_point next_cycle_due(const Rehearsal& rehearsal, Clock::time_point now) const;
    void finish(Rehearsal& rehearsal);
    /// What was once asked of this run, asked again.
    static bool repeat(Rehearsal& rehearsal, const std::string& request);
    /// @return the replies of those that were refused, or of all in a dry run; empty: each may be taken
    static std::vector<v1::CommandReply> look_at(Rehearsal& rehearsal, const SendCommands& order);
    void collect(Rehearsal& rehearsal, const telemetry::Received& received);
    void take_stages(Rehearsal& rehearsal);
    bool deliver(const Rehearsal& rehearsal, Clock::time_point now);
    void tell(const Rehearsal& rehearsal, Clock::time_point now, bool changed);
    v1::RunState state(const Rehearsal& rehearsal) const;
    std::string state_word() const;
    std::string outcome(const Rehearsal& rehearsal) const;  ///< "stopped" when it was cut short

    simulation::Scenario scenario_;
    std::uint64_t seed_;
    std::optional<archive::CutOffRun> cut_;
    const dictionary::Dictionary& dictionary_;
    PipelineThread& pipeline_;
    Callbacks callbacks_;

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<RunOrder> orders_;                    ///< under mutex_; for the next cycle
    bool stop_ = false, over_ = false;                ///< under mutex_
    std::size_t faults_taken_ = 0, notes_taken_ = 0;  ///< under mutex_; in this sitting
    std::map<std::uint64_t, std::string> names_;      ///< under mutex_; of the run's commands, by number

    std::atomic<std::size_t> queued_{0}, at_uplink_{0};

    // Of the rehearsal's thread only.
    archive::RunId run_id_;
    archive::RunStart start_;
    Delivery delivery_;
    bool timeline_moved_ = false;  ///< by what is in delivery_
    bool paused_ = false, finished_ = false, stopped_ = false, archive_gave_up_ = false;
    double pace_ = 1.0, attained_pace_ = 0.0;
    Clock::time_point pace_since_{};  ///< the pace counts from here, and from cycle pace_since_cycle_
    std::uint64_t pace_since_cycle_ = 0;
    std::string digest_;
    Clock::time_point delivered_{}, clocks_told_{}, state_told_{}, links_told_{};
    std::uint64_t cycles_told_ = 0;

    std::thread thread_;
};

}  // namespace aeolis::server
