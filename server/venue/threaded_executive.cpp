// SPDX-License-Identifier: Apache-2.0
#include "server/venue/threaded_executive.hpp"

#include "flight/kernel/deadlines.hpp"
#include "flight/kernel/dispatch.hpp"
#include "flight/kernel/interrupts.hpp"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>
#include <utility>

namespace aeolis::server {
namespace {

constexpr std::uint8_t paint = 0xA5;
constexpr int lowest_priority = 10;  // chosen: above all ordinary threads, below the kernel's

std::uint64_t thread_cpu_ns() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<std::uint64_t>(time.tv_sec) * 1'000'000'000U + static_cast<std::uint64_t>(time.tv_nsec);
}

/// The octets of a painted stack that are still painted. Its thread is idle but not ended; the thread sanitizer would
/// report a race with the thread's start, which wrote there.
__attribute__((no_sanitize("thread"))) std::size_t untouched_octets(const std::uint8_t* stack, std::size_t octets) {
    std::size_t untouched = 0;
    while (untouched < octets && stack[untouched] == paint) ++untouched;
    return untouched;
}

}  // namespace

/// One module's thread. It waits only for its mailbox; a module of the rate group is woken only for its turn.
class ThreadedExecutive::Task {
  public:
    Task(ThreadedExecutive& house, flight::ModuleId id) : house_(house), id_(id) {
        times_.module = id;
        // A guard page below the stack: an overflow ends the program instead of writing elsewhere.
        guard_octets_ = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
        void* room =
            mmap(nullptr, guard_octets_ + stack_octets, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        AEOLIS_CHECK(room != MAP_FAILED);
        AEOLIS_CHECK(mprotect(room, guard_octets_, PROT_NONE) == 0);
        stack_ = static_cast<std::uint8_t*>(room) + guard_octets_;
        std::memset(stack_, paint, stack_octets);
        start();
    }
    ~Task() {
        {
            const std::lock_guard lock{mutex_};
            stop_ = true;
        }
        wake_.notify_one();
        pthread_join(thread_, nullptr);
        munmap(stack_ - guard_octets_, guard_octets_ + stack_octets);
    }
    Task(const Task&) = delete;
    Task& operator=(const Task&) = delete;

    bool push(const flight::Message& message) {
        const std::lock_guard lock{mutex_};
        return mailbox().try_push(message);
    }
    void wake() {
        {
            const std::lock_guard lock{mutex_};
            if (ready_) return;
            ready_ = true;
            const std::lock_guard house{house_.mutex_};
            ++house_.running_;
        }
        wake_.notify_one();
    }
    FixedVector<flight::Envelope, 128>& later() { return later_; }
    /// The time used in the last cycle; none when the task did not run.
    std::optional<std::uint64_t> take_cycle_ns() {
        const auto spent_ns = std::exchange(cycle_ns_, std::nullopt);
        if (spent_ns) times_.cycle.add(*spent_ns);
        return spent_ns;
    }
    TaskTimes times() const {
        TaskTimes times = times_;
        times.stack_used_octets = stack_octets - untouched_octets(stack_, stack_octets);
        return times;
    }

  private:
    /// Mailboxes are part of the computer's state: a restart or a copy takes no stale mail along.
    FixedQueue<flight::Message, flight::mailbox_messages_max>& mailbox() {
        return house_.state_->mailboxes[static_cast<std::size_t>(id_)];
    }

    void start() {
        pthread_attr_t attributes;
        pthread_attr_init(&attributes);
        pthread_attr_setstack(&attributes, stack_, stack_octets);
        const auto enter = [](void* task) -> void* {
            static_cast<Task*>(task)->run();
            return nullptr;
        };
        int failed = EPERM;
        if (house_.options_.clock == Clock::real_time) {
            sched_param priority{};
            priority.sched_priority = lowest_priority + static_cast<int>(flight::module_count) - static_cast<int>(id_);
            pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
            pthread_attr_setschedpolicy(&attributes, SCHED_FIFO);
            pthread_attr_setschedparam(&attributes, &priority);
            failed = pthread_create(&thread_, &attributes, enter, this);
            if (failed != 0) {
                house_.notice_ = "tasks run without real-time priorities (SCHED_FIFO is not permitted here: " +
                                 std::string{std::strerror(failed)} + "); deadlines depend on what else runs";
                pthread_attr_setinheritsched(&attributes, PTHREAD_INHERIT_SCHED);
            }
        }
        if (failed != 0) failed = pthread_create(&thread_, &attributes, enter, this);
        pthread_attr_destroy(&attributes);
        AEOLIS_CHECK(failed == 0);
    }

    void run() {
        for (;;) {
            {
                std::unique_lock lock{mutex_};
                wake_.wait(lock, [this] { return ready_ || stop_; });
                if (stop_) return;
                ready_ = false;
            }
            take_mail();
            const std::lock_guard lock{house_.mutex_};
            if (--house_.running_ == 0) house_.idle_.notify_all();
        }
    }

    void take_mail() {
        const std::uint64_t began_ns = house_.options_.measure ? thread_cpu_ns() : 0;
        try {
            if (house_.options_.before_mail) house_.options_.before_mail(id_, house_.now_);
            while (const auto message = next()) handle(*message);
        } catch (const CheckFailed& bug) {
            const std::lock_guard lock{house_.mutex_};
            if (!house_.failed_) house_.failed_ = bug;
        }
        if (house_.options_.measure) cycle_ns_ = cycle_ns_.value_or(0) + thread_cpu_ns() - began_ns;
    }

    std::optional<flight::Message> next() {
        const std::lock_guard lock{mutex_};
        if (mailbox().empty()) return std::nullopt;
        const flight::Message message = mailbox().front();
        mailbox().pop();
        return message;
    }

    void handle(const flight::Message& message) {
        const std::uint64_t began_ns = house_.options_.measure ? thread_cpu_ns() : 0;
        outbox_.begin(id_, house_.now_, *house_.out_);
        const bool expected = flight::with_module(
            *house_.state_, id_, [&](auto& module) { return flight::handle(module, message, outbox_); });
        if (house_.options_.measure) times_.by_message[message.index()].add(thread_cpu_ns() - began_ns);
        if (!expected) ++house_.unexpected_;
        house_.overflows_ += outbox_.dropped();
        for (const flight::Envelope& envelope : outbox_.sent()) {
            if (!flight::in_rate_group(id_)) {
                if (!later_.try_push_back(envelope)) ++house_.overflows_;
                continue;
            }
            if (house_.post(envelope.to, envelope.message)) house_.task(envelope.to).wake();
        }
    }

    ThreadedExecutive& house_;
    flight::ModuleId id_;
    std::uint8_t* stack_ = nullptr;
    std::size_t guard_octets_ = 0;
    pthread_t thread_{};
    std::mutex mutex_;
    std::condition_variable wake_;
    bool ready_ = false, stop_ = false;
    // Used by the task's own thread; read by others only while it is idle.
    flight::Outbox outbox_;
    FixedVector<flight::Envelope, 128> later_;
    std::optional<std::uint64_t> cycle_ns_;  // so far in this cycle
    TaskTimes times_;
};

ThreadedExecutive::ThreadedExecutive(Options options) : options_(std::move(options)) {
    for (std::size_t id = 0; id < flight::module_count; ++id)
        tasks_.push_back(std::make_unique<Task>(*this, static_cast<flight::ModuleId>(id)));
}

ThreadedExecutive::~ThreadedExecutive() = default;

bool ThreadedExecutive::post(flight::ModuleId to, const flight::Message& message) {
    if (!flight::is_loaded(state_->load.role, to)) return false;
    if (!task(to).push(message)) ++overflows_;
    return flight::wakes(to, message);
}

void ThreadedExecutive::cycle(flight::ComputerState& state, const flight::DeviceInputs& in,
                              flight::DeviceOutputs& out) {
    state_ = &state;
    out_ = &out;
    now_ = in.now;
    ticks_skipped_ = 0;
    out.begin_cycle();
    state.now = in.now;
    state.sync.set_executive_counts(state.mailbox_overflows, state.unexpected_messages);

    // All messages of the tick are in mailboxes before the first task runs.
    std::uint32_t awake = 0;
    const auto deliver = [&](flight::ModuleId to, const flight::Message& message) {
        if (post(to, message)) awake |= flight::bit_of(to);
    };
    for (const flight::Envelope& envelope : state.next_cycle) deliver(envelope.to, envelope.message);
    state.next_cycle.clear();
    flight::post_interrupts(in, deliver);
    for (std::size_t id = 0; id < flight::module_count; ++id)
        if ((awake & flight::bit_of(static_cast<flight::ModuleId>(id))) != 0) tasks_[id]->wake();

    wait_until_idle();
    ticks_not_taken_ += ticks_skipped_;
    collect(state);
    if (options_.measure) report_times(state);
}

void ThreadedExecutive::wait_until_idle() {
    using namespace std::chrono;
    const auto tick = duration_cast<steady_clock::duration>(duration<double>{seconds_per_tick});
    auto deadline = steady_clock::now() + tick;
    std::unique_lock lock{mutex_};
    const auto is_idle = [this] { return running_ == 0; };
    while (!is_idle()) {
        if (options_.clock == Clock::virtual_time) {
            idle_.wait(lock, is_idle);
        } else if (!idle_.wait_until(lock, deadline, is_idle)) {
            // The clock does not wait: its interrupt is a message to sync, which finds its group still running.
            ++ticks_skipped_;
            deadline += tick;
            lock.unlock();
            const Sclk late = now_ + ticks_skipped_ * seconds_per_tick;
            if (post(flight::ModuleId::sync, flight::ClockTick{late})) task(flight::ModuleId::sync).wake();
            lock.lock();
        }
    }
}

void ThreadedExecutive::collect(flight::ComputerState& state) {
    state.mailbox_overflows += overflows_.exchange(0);
    state.unexpected_messages += unexpected_.exchange(0);
    if (options_.measure) {
        std::uint64_t together_ns = 0;
        for (auto& one : tasks_) together_ns += one->take_cycle_ns().value_or(0);
        all_tasks_.add(together_ns);
    }
    if (failed_) {
        for (auto& one : tasks_) one->later().clear();  // mailboxes are discarded with the state
        const CheckFailed bug = *failed_;
        failed_.reset();
        throw CheckFailed{bug};
    }
    // In order of priority, as the deterministic executive would have run them.
    for (auto& one : tasks_) {
        for (const flight::Envelope& envelope : one->later())
            if (!state.next_cycle.try_push_back(envelope)) ++state.mailbox_overflows;
        one->later().clear();
    }
}

void ThreadedExecutive::report_times(flight::ComputerState& state) {
    if (at_resolution(now_, 1) != now_) return;
    const TaskTimes times = tasks_[next_reported_]->times();
    next_reported_ = (next_reported_ + 1) % tasks_.size();
    const auto f = [](double value) { return static_cast<float>(value); };
    state.outbox.begin(times.module, now_, *out_);
    state.outbox.record(flight::packet::TaskTimes{
        .task_number = static_cast<std::uint8_t>(times.module),
        .task_cycles = static_cast<std::uint32_t>(times.cycle.count()),
        .task_least_us = f(times.cycle.least_us()),
        .task_mean_us = f(times.cycle.mean_us()),
        .task_p999_us = f(times.cycle.p999_us()),
        .task_worst_us = f(times.cycle.worst_us()),
        .task_budget_us = f(flight::limits_of(times.module).budget_us),
        .task_unevenness = f(unevenness(times)),
        .task_stack_octets = static_cast<std::uint32_t>(times.stack_used_octets),
    });
    for (const flight::Envelope& envelope : state.outbox.sent()) (void)state.next_cycle.try_push_back(envelope);
}

MeasuredTimes ThreadedExecutive::times() const {
    MeasuredTimes measured{{}, all_tasks_};
    measured.tasks.reserve(tasks_.size());
    for (const auto& one : tasks_) measured.tasks.push_back(one->times());
    return measured;
}

}  // namespace aeolis::server
