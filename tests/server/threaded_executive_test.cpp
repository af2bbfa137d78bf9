// SPDX-License-Identifier: Apache-2.0
#include "server/venue/threaded_executive.hpp"

#include "flight/computer.hpp"
#include "flight/kernel/deadlines.hpp"
#include "simulation/entry_reference.hpp"
#include "simulation/landing.hpp"
#include "simulation/world.hpp"
#include "telemetry/packet_stream.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/telecommands.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <set>
#include <thread>

namespace server_threaded_executive_test {

using namespace aeolis;
using namespace aeolis::server;

namespace {

struct CommandedLanding {
    simulation::Landing landing;
    std::vector<std::uint8_t> tones;

    explicit CommandedLanding(std::shared_ptr<flight::CycleRunner> runner, double start_before_entry_s = 900.0)
        : landing(tests::gale_scenario(start_before_entry_s), 1) {
        landing.run_prime_by(std::move(runner));
        landing.uplink(test::set_parameters(landing.solution()));
        fly(1.0);
        landing.uplink(test::do_edl());
    }
    void step() {
        for (const auto& symbol : landing.step().symbols) tones.push_back(symbol.tone.value);
    }
    void fly(double for_s) {
        for (double flown_s = 0.0; flown_s < for_s; flown_s += seconds_per_tick) step();
    }
};

bool same_recording(const simulation::Landing& a, const simulation::Landing& b) {
    return std::ranges::equal(a.recording(), b.recording());
}

/// A computer alone, at a pace of its own.
struct Bench {
    flight::Computer computer{flight::Load{}, Sclk{1000.0}};
    std::unique_ptr<flight::DeviceOutputs> out = std::make_unique<flight::DeviceOutputs>();
    flight::DeviceInputs in;
    Sclk now{1000.0};

    void cycle(flight::CycleRunner& runner, int ticks = 1) {
        now = now + ticks * seconds_per_tick;
        in.now = now;
        in.nvm_capacity_octets = 1U << 30;
        computer.step(in, *out, &runner);
    }
};

/// Flight's own bound; under a sanitizer, which puts much of its own on the stack, half of what there is.
std::size_t stack_bound_octets([[maybe_unused]] flight::ModuleId module) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    return ThreadedExecutive::stack_octets / 2;
#else
    return flight::limits_of(module).stack_octets;
#endif
}

void check_stacks(const ThreadedExecutive& executive) {
    for (const TaskTimes& times : executive.times().tasks) {
        INFO("task " << static_cast<int>(times.module));
        CHECK(times.stack_used_octets <= stack_bound_octets(times.module));
    }
}

/// Takes so much of its thread's processor time.
void work(double seconds) {
    const auto spent_s = [] {
        timespec time{};
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
        return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1.0e-9;
    };
    const double until_s = spent_s() + seconds;
    while (spent_s() < until_s) {
    }
}

/// Keeps a task busy until so many ticks came too early for it, however busy the machine is.
struct LateTicks {
    std::atomic<int> sync_mails{0};

    /// In the task's thread: nothing but late ticks reaches sync while the task has not confirmed.
    void await(int ticks) const {
        const int before = sync_mails;
        const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds{20};
        while (sync_mails < before + ticks && std::chrono::steady_clock::now() < give_up)
            std::this_thread::sleep_for(std::chrono::milliseconds{1});
    }
};

}  // namespace

TEST_CASE("both executives fly one landing alike: recorded packets, firings, events and tones, bit for bit; no task "
          "passes its bound of stack",
          "[venue][threads][R8][R37]") {
    const auto executive = std::make_shared<ThreadedExecutive>();
    CommandedLanding deterministic{nullptr};
    CommandedLanding threaded{executive};
    while (deterministic.landing.outcome() == simulation::Outcome::running) {
        deterministic.step();
        threaded.step();
    }
    CHECK(deterministic.landing.outcome() == simulation::Outcome::touchdown);
    CHECK(threaded.landing.outcome() == simulation::Outcome::touchdown);
    CHECK(same_recording(deterministic.landing, threaded.landing));
    CHECK(deterministic.tones == threaded.tones);
    CHECK(threaded.landing.counters().overruns == 0);
    CHECK(threaded.landing.counters().mailbox_overflows == 0);
    check_stacks(*executive);
}

TEST_CASE("both executives are alike through a restart of prime and a change of roles, bit for bit, within the same "
          "bounds of stack",
          "[venue][threads][R8][R32]") {
    const auto fly = [](std::shared_ptr<flight::CycleRunner> runner) {
        simulation::Landing landing{tests::gale_scenario(17000.0), 1};
        landing.run_prime_by(std::move(runner));
        const auto pass = [&](double for_s) {
            for (double flown_s = 0.0; flown_s < for_s; flown_s += seconds_per_tick) landing.step();
        };
        landing.uplink(test::set_parameters(landing.solution()));
        pass(1.0);
        landing.uplink(test::select_prime_b());
        pass(60.0);
        landing.uplink(test::do_edl());
        pass(4.0);
        landing.reset_prime();
        pass(60.0);
        return landing;
    };
    const auto deterministic = fly(nullptr);
    const auto executive = std::make_shared<ThreadedExecutive>();
    const auto threaded = fly(executive);
    CHECK(deterministic.counters().resets == 3);
    CHECK(threaded.counters().resets == 3);
    CHECK(same_recording(deterministic, threaded));
    check_stacks(*executive);
}

TEST_CASE("a task that takes too long: sync reports the overruns, those cycles are skipped, SCLK goes on",
          "[venue][threads][R8][R22]") {
    const Sclk slow_at{1000.0 + 20 * seconds_per_tick};
    ThreadedExecutive::Options options;
    options.clock = ThreadedExecutive::Clock::real_time;
    LateTicks late;
    options.before_mail = [&](flight::ModuleId module, Sclk now) {
        if (module == flight::ModuleId::sync) ++late.sync_mails;
        if (module == flight::ModuleId::edl && now == slow_at) late.await(3);
    };
    ThreadedExecutive executive{options};
    Bench bench;
    int skipped = 0, not_flown = 0;
    for (int i = 0; i < 40; ++i) {
        bench.cycle(executive, 1 + not_flown);
        not_flown = executive.take_ticks_skipped();
        if (bench.now == slow_at) skipped = not_flown;
    }
    CHECK(skipped >= 3);
    CHECK(bench.computer.counters().overruns >= 3);
    // Each tick is a cycle that was run or one that was skipped: none is lost.
    CHECK(bench.computer.counters().cycles + bench.computer.counters().overruns ==
          static_cast<std::uint64_t>((bench.now - Sclk{1000.0}) * 64.0) + static_cast<std::uint64_t>(not_flown));
}

TEST_CASE("an overrun in a landing: the vehicle flies on through the skipped cycles, and SCLK stays in step with it",
          "[venue][threads][R8][R22]") {
    ThreadedExecutive::Options options;
    options.clock = ThreadedExecutive::Clock::real_time;
    Sclk slow_at, told;  // the tick that the computer's clock interrupt brought last
    LateTicks late;
    options.before_mail = [&](flight::ModuleId module, Sclk now) {
        if (module == flight::ModuleId::sync) {
            told = now;
            ++late.sync_mails;
        }
        if (module == flight::ModuleId::edl && now == slow_at) late.await(3);
    };
    simulation::Landing landing{tests::gale_scenario(700.0), 1};
    const Sclk start = landing.sclk();
    slow_at = start + 20 * seconds_per_tick;
    landing.run_prime_by(std::make_shared<ThreadedExecutive>(options));
    int flown = 0, skipped_then = 0;
    for (int i = 0; i < 40; ++i) {
        const Sclk now = landing.sclk();
        const int skipped = landing.step().ticks_skipped;
        CHECK(told == now);  // never the same tick twice
        flown += 1 + skipped;
        CHECK(landing.sclk() == start + flown * seconds_per_tick);
        CHECK(landing.truth().sclk == landing.sclk());
        if (now == slow_at) skipped_then = skipped;
    }
    CHECK(skipped_then >= 3);
    CHECK(landing.counters().overruns >= 3);
}

TEST_CASE("a check that fails in a task's thread resets the computer and nothing else", "[venue][threads][R8]") {
    const Sclk at{1000.0 + 10 * seconds_per_tick};
    ThreadedExecutive::Options options;
    options.before_mail = [&](flight::ModuleId module, Sclk now) {
        if (module == flight::ModuleId::edl && now == at) throw CheckFailed{"planted", "a test", 1};
    };
    ThreadedExecutive executive{options};
    Bench bench;
    for (int i = 0; i < 9; ++i) bench.cycle(executive);
    CHECK(bench.out->in_command);
    bench.cycle(executive);
    CHECK_FALSE(bench.out->in_command);
    CHECK(bench.computer.counters().resets == 1);
    CHECK(bench.computer.counters().cycles == 0);
    for (int i = 0; i < static_cast<int>(flight::restart_s * 64.0) + 10; ++i) bench.cycle(executive);
    CHECK(bench.computer.counters().resets == 1);
    CHECK(bench.computer.counters().cycles >= 10);
    CHECK(bench.out->in_command);
}

TEST_CASE("each task's processor time is measured by message, keeps its budget on average, and is told in telemetry",
          "[venue][threads][R8][R37]") {
    ThreadedExecutive::Options options;
    options.measure = true;
    const auto executive = std::make_shared<ThreadedExecutive>(options);
    CommandedLanding run{executive, 700.0};
    run.fly(30.0);
    std::set<flight::ModuleId> told;
    telemetry::PacketStream packets{run.landing.recording()};
    while (const auto packet = packets.next())
        if (read_primary_header(*packet)->apid == flight::packet::TaskTimes::apid)
            told.insert(static_cast<flight::ModuleId>(read_bits(*packet, tm_data_offset_octets * 8, 8)));
    CHECK(told.size() == flight::module_count);
    for (const TaskTimes& times : executive->times().tasks) {
        INFO("task " << static_cast<int>(times.module));
        std::uint64_t handled = 0;
        for (const Durations& of_type : times.by_message) handled += of_type.count();
        CHECK((handled > 0) == (times.cycle.count() > 0));
        // On average only: the worst belongs to this machine's other work as well. bench/threaded_bench has all of it.
        CHECK(times.cycle.mean_us() <= flight::limits_of(times.module).budget_us);
        CHECK(times.stack_used_octets > 0);
    }
}

TEST_CASE("a task's time is what it took in a whole cycle, however often it was woken; all tasks' that of one cycle",
          "[venue][threads][R8]") {
    const Sclk sync_works_at{1000.0 + 10 * seconds_per_tick}, edl_works_at{1000.0 + 20 * seconds_per_tick};
    int woken = 0;  // sync, in that cycle
    ThreadedExecutive::Options options;
    options.measure = true;
    options.before_mail = [&](flight::ModuleId module, Sclk now) {
        if (module == flight::ModuleId::sync && now == sync_works_at) {
            ++woken;
            work(0.002);
        }
        // So long that sync has come to rest and is woken again.
        if (module == flight::ModuleId::imu && now == sync_works_at)
            std::this_thread::sleep_for(std::chrono::milliseconds{50});
        if (module == flight::ModuleId::edl && now == edl_works_at) work(0.003);
        if (module == flight::ModuleId::mfsk && now == edl_works_at) work(0.003);
    };
    ThreadedExecutive executive{options};
    Bench bench;
    for (int i = 0; i < 40; ++i) bench.cycle(executive);
    const MeasuredTimes times = executive.times();
    const auto task = [&](flight::ModuleId id) { return times.tasks[static_cast<std::size_t>(id)].cycle; };
    REQUIRE(woken >= 2);
    CHECK(task(flight::ModuleId::sync).count() == 40);
    CHECK(task(flight::ModuleId::sync).worst_us() >= woken * 2000.0);
    CHECK(task(flight::ModuleId::edl).worst_us() >= 3000.0);
    CHECK(task(flight::ModuleId::power).count() == 0);
    CHECK(times.all_tasks.count() == 40);
    CHECK(times.all_tasks.worst_us() >= std::max(woken * 2000.0, 6000.0));
    // Never the worst of two cycles together.
    CHECK(times.all_tasks.worst_us() < task(flight::ModuleId::sync).worst_us() + 6000.0);
}

}  // namespace server_threaded_executive_test
