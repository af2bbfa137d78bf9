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

/// The threaded executive: each module a task with a thread of its own and one blocking wait, its mailbox; priorities
/// by deadline (flight/kernel/deadlines.hpp), SCHED_FIFO where the system permits. R4, R8
///
/// In       one tick's inputs, by cycle()                 Out   the same bits as the deterministic executive gives
/// Clock    virtual: cycle() returns when every task is idle, however long that took. Real: a cycle that is not done
///          within 1/64 s gets the next tick all the same, as from the clock's interrupt: sync finds its group still
///          running, reports the overrun and skips that cycle; take_ticks_skipped() says how many, SCLK goes on
/// Memory   made with it: an outbox and a painted stack of 256 KiB a task; mailboxes are the computer's
/// Faults   a task whose check fails: cycle() throws it once all tasks are idle; what lies in mailboxes goes with the
///          state that failed
class ThreadedExecutive final : public flight::CycleRunner {
  public:
    enum class Clock { virtual_time, real_time };
    struct Options {
        Clock clock = Clock::virtual_time;
        bool measure = false;  ///< processor time of every message; costs about a microsecond each
        /// A fault put in by a test: called by the task's own thread before it takes its mail.
        std::function<void(flight::ModuleId, Sclk)> before_mail;
    };

    ThreadedExecutive() : ThreadedExecutive(Options{}) {}
    explicit ThreadedExecutive(Options options);
    ~ThreadedExecutive() override;
    ThreadedExecutive(const ThreadedExecutive&) = delete;
    ThreadedExecutive& operator=(const ThreadedExecutive&) = delete;

    void cycle(flight::ComputerState& state, const flight::DeviceInputs& in, flight::DeviceOutputs& out) override;

    /// Nil on a virtual clock.
    int take_ticks_skipped() override { return std::exchange(ticks_not_taken_, 0); }
    /// Empty when tasks run at real-time priorities, else why not, for people.
    const std::string& notice() const { return notice_; }
    MeasuredTimes times() const;
#if defined(__SANITIZE_THREAD__)
    static constexpr std::size_t stack_octets = 4 * 1024 * 1024;  ///< the sanitizer keeps a thread's state on its stack
#else
    static constexpr std::size_t stack_octets = 256 * 1024;
#endif

  private:
    class Task;

    /// True when the message makes its module run: whoever posts it wakes the task. False, too, in a load without it.
    bool post(flight::ModuleId to, const flight::Message& message);
    void wait_until_idle();
    void collect(flight::ComputerState& state);
    void report_times(flight::ComputerState& state);
    Task& task(flight::ModuleId id) { return *tasks_[static_cast<std::size_t>(id)]; }

    Options options_;
    std::string notice_;
    std::vector<std::unique_ptr<Task>> tasks_;
    flight::ComputerState* state_ = nullptr;  ///< of the cycle that runs
    flight::DeviceOutputs* out_ = nullptr;
    Sclk now_;
    std::atomic<std::uint32_t> overflows_{0}, unexpected_{0};

    std::mutex mutex_;
    std::condition_variable idle_;
    int running_ = 0;  ///< tasks that have something to run for; under mutex_
    std::optional<CheckFailed> failed_;
    int ticks_skipped_ = 0;    ///< in the cycle that runs
    int ticks_not_taken_ = 0;  ///< in cycles before, not told yet
    Durations all_tasks_;      ///< of each cycle
    std::size_t next_reported_ = 0;
};

}  // namespace aeolis::server
