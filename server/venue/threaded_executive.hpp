// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/computer_state.hpp"
#include "flight/kernel/cycle_runner.hpp"
#include "server/venue/task_times.hpp"

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace aeolis::server {

/// The threaded executive: each module is a task with its own thread and one blocking wait, on its mailbox. Priorities
/// follow the deadlines (flight/kernel/deadlines.hpp), with SCHED_FIFO where the system permits. R4, R8
///
/// In       one tick's inputs, by cycle()                 Out   bit for bit what the deterministic executive gives
/// Clock    virtual: cycle() returns when every task is idle, however long that takes. Real: a cycle not done within
///          1/64 s gets the next tick all the same, as from the clock's interrupt: sync finds its group still running,
///          reports the overrun and skips that cycle. take_ticks_skipped() gives their number; SCLK proceeds
/// Memory   allocated with it: an outbox and a painted stack of 256 KiB per task; mailboxes are the computer's
/// Faults   a failed check in a task: cycle() throws it once all tasks are idle; queued mail is lost with the failed
///          state
class ThreadedExecutive final : public flight::CycleRunner {
  public:
    enum class Clock { virtual_time, real_time };
    struct Options {
        Clock clock = Clock::virtual_time;
        bool measure = false;  ///< processor time of each message; costs about 1 us each
        /// A fault injected by a test: called on the task's thread before it takes its mail.
        std::function<void(flight::ModuleId, Sclk)> before_mail;
    };

    ThreadedExecutive() : ThreadedExecutive(Options{}) {}
    explicit ThreadedExecutive(Options options);
    ~ThreadedExecutive() override;
    ThreadedExecutive(const ThreadedExecutive&) = delete;
    ThreadedExecutive& operator=(const ThreadedExecutive&) = delete;

    void cycle(flight::ComputerState& state, const flight::DeviceInputs& in, flight::DeviceOutputs& out) override;

    /// Clock ticks lost since the last call; zero on a virtual clock.
    int take_ticks_skipped() override { return std::exchange(ticks_not_taken_, 0); }
    /// Why tasks do not run at real-time priorities, in words; empty when they do.
    const std::string& notice() const { return notice_; }
    MeasuredTimes times() const;
#if defined(__SANITIZE_THREAD__)
    static constexpr std::size_t stack_octets = 4 * 1024 * 1024;  ///< the sanitizer keeps a thread's state on its stack
#else
    static constexpr std::size_t stack_octets = 256 * 1024;
#endif

  private:
    class Task;

    /// Posts a message. True when its module must run, so that the poster wakes it; false also in a load without that
    /// module.
    bool post(flight::ModuleId to, const flight::Message& message);
    void wait_until_idle();
    void collect(flight::ComputerState& state);
    void report_times(flight::ComputerState& state);
    Task& task(flight::ModuleId id) { return *tasks_[static_cast<std::size_t>(id)]; }

    Options options_;
    std::string notice_;
    std::vector<std::unique_ptr<Task>> tasks_;
    flight::ComputerState* state_ = nullptr;  ///< of the running cycle
    flight::DeviceOutputs* out_ = nullptr;
    Sclk now_;
    std::atomic<std::uint32_t> overflows_{0}, unexpected_{0};

    std::mutex mutex_;
    std::condition_variable idle_;
    int running_ = 0;  ///< under mutex_: tasks with something to do
    std::optional<CheckFailed> failed_;
    int ticks_skipped_ = 0;    ///< in the running cycle
    int ticks_not_taken_ = 0;  ///< in earlier cycles, not yet reported
    Durations all_tasks_;      ///< per cycle
    std::size_t next_reported_ = 0;
};

}  // namespace aeolis::server
