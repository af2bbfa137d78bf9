// SPDX-License-Identifier: Apache-2.0
// Measures the threaded executive over a whole landing.
//
// It prints each task's processor time in a cycle against its budget, by message, and the deepest use of its stack.
//
// It runs on a virtual clock, as fast as possible; with AEOLIS_REAL_TIME=1 at 1 x, for a quarter of an hour and more,
// with wall-clock overruns and jitter. AEOLIS_SECONDS=N ends after N seconds of flight.
//
// Goal: no cycle's own processor time, summed over all its tasks, above 1/64 s; each task within its budget in 999 of
// 1000 cycles.
#include "server/scenario/scenario_text.hpp"
#include "server/venue/task_report.hpp"
#include "server/venue/threaded_executive.hpp"
#include "simulation/landing.hpp"
#include "tests/support/telecommands.hpp"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <thread>

namespace {

using namespace aeolis;

}  // namespace

int main() {
    const auto scenario = server::scenario_from_file(AEOLIS_SOURCE_DIR "/simulation/scenarios/nominal_auto.textproto");
    if (!scenario) return std::fprintf(stderr, "%s\n", scenario.error().message.c_str()), 1;
    const bool real_time = std::getenv("AEOLIS_REAL_TIME") != nullptr;
    const char* seconds = std::getenv("AEOLIS_SECONDS");
    const double end_s = seconds != nullptr ? std::atof(seconds) : 1.0e9;

    server::ThreadedExecutive::Options options;
    options.measure = true;
    if (real_time) options.clock = server::ThreadedExecutive::Clock::real_time;
    const auto executive = std::make_shared<server::ThreadedExecutive>(options);
    if (real_time && !executive->notice().empty()) std::printf("notice: %s\n", executive->notice().c_str());

    simulation::Landing landing{*scenario, 1};
    landing.run_prime_by(executive);
    landing.uplink(test::set_parameters(landing.solution()));

    using clock = std::chrono::steady_clock;
    server::Durations lateness;
    const auto began = clock::now();
    std::uint64_t ticks = 0, skipped = 0;
    while (landing.outcome() == simulation::Outcome::running && static_cast<double>(ticks) * seconds_per_tick < end_s) {
        if (real_time) {
            const auto due = began + std::chrono::duration_cast<clock::duration>(
                                         std::chrono::duration<double>{static_cast<double>(ticks) * seconds_per_tick});
            std::this_thread::sleep_until(due);
            lateness.add(static_cast<std::uint64_t>(std::chrono::nanoseconds{clock::now() - due}.count()));
        }
        const auto skipped_now = static_cast<std::uint64_t>(landing.step().ticks_skipped);
        if (ticks < 64 && ticks + 1 + skipped_now >= 64) landing.uplink(test::do_edl());
        ticks += 1 + skipped_now;
        skipped += skipped_now;
    }
    const double wall_s = std::chrono::duration<double>{clock::now() - began}.count();

    std::printf("%s%llu ticks in %.1f s\n", server::task_table(executive->times()).c_str(),
                static_cast<unsigned long long>(ticks), wall_s);
    std::printf("overruns that sync counted: %llu; ticks that passed in a cycle beyond its own: %llu\n",
                static_cast<unsigned long long>(landing.counters().overruns), static_cast<unsigned long long>(skipped));
    if (real_time)
        std::printf("lateness of a tick: mean %.0f us, 99.9 %% %.0f us, worst %.0f us\n", lateness.mean_us(),
                    lateness.p999_us(), lateness.worst_us());
    return server::within_budgets(executive->times()) ? 0 : 1;
}
