// The threaded executive over a whole landing: processor time of each task in a cycle against its budget, by message, and
// the deepest use of its stack. On a virtual clock, as fast as it goes; with AEOLIS_REAL_TIME=1 at 1 x, a quarter of an
// hour and more, with wall-clock overruns and jitter. AEOLIS_SECONDS=N ends after N seconds of flight.
//
// Goal: no cycle's own processor time, of all tasks together, above 1/64 s.
#include "flight/kernel/deadlines.hpp"
#include "server/scenario/scenario_text.hpp"
#include "server/venue/threaded_executive.hpp"
#include "simulation/landing.hpp"
#include "tests/support/telecommands.hpp"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string_view>
#include <thread>

namespace {

using namespace aeolis;

/// The last word of what the compiler calls its template argument: a message's type, a module.
constexpr std::string_view argument_in(std::string_view signature) {
    signature = signature.substr(signature.find(" = ") + 3);
    signature = signature.substr(0, signature.find_first_of(";]"));
    return signature.substr(signature.rfind(':') + 1);  // all of it where there is none
}
template <typename Message>
std::string_view type_name() {
    return argument_in(__PRETTY_FUNCTION__);
}
template <flight::ModuleId id>
std::string_view module_name() {
    return argument_in(__PRETTY_FUNCTION__);
}
template <std::size_t... I>
std::vector<std::string_view> message_names(std::index_sequence<I...>) {
    return {type_name<std::variant_alternative_t<I, flight::Message>>()...};
}
template <std::size_t... I>
std::vector<std::string_view> module_names(std::index_sequence<I...>) {
    return {module_name<static_cast<flight::ModuleId>(I)>()...};
}

void print(const server::TaskTimes& task) {
    static const auto modules = module_names(std::make_index_sequence<flight::module_count>{});
    static const auto messages = message_names(std::make_index_sequence<server::message_type_count>{});
    const std::string_view name = modules[static_cast<std::size_t>(task.module)];
    const double budget_us = flight::limits_of(task.module).budget_us;
    std::printf("%-24.*s %9llu %8.1f %8.1f %8.1f %8.1f %8.0f %6.2f %7.1f %7zu\n", static_cast<int>(name.size()), name.data(),
                static_cast<unsigned long long>(task.cycle.count()), task.cycle.least_us(), task.cycle.mean_us(),
                task.cycle.p999_us(), task.cycle.worst_us(), budget_us, task.cycle.p999_us() / budget_us,
                server::unevenness(task), task.stack_used_octets);
    for (std::size_t type = 0; type < task.by_message.size(); ++type)
        if (const auto& times = task.by_message[type]; times.count() > 0)
            std::printf("  %-22.*s %9llu %8.1f %8.1f %8.1f %8.1f\n", static_cast<int>(messages[type].size()),
                        messages[type].data(), static_cast<unsigned long long>(times.count()), times.least_us(),
                        times.mean_us(), times.p999_us(), times.worst_us());
}

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
    std::uint64_t cycles = 0, skipped = 0;
    while (landing.outcome() == simulation::Outcome::running && static_cast<double>(cycles) * seconds_per_tick < end_s) {
        if (real_time) {
            const auto due = began + std::chrono::duration_cast<clock::duration>(
                                         std::chrono::duration<double>{static_cast<double>(cycles) * seconds_per_tick});
            std::this_thread::sleep_until(due);
            lateness.add(static_cast<std::uint64_t>(std::chrono::nanoseconds{clock::now() - due}.count()));
        }
        landing.step();
        if (++cycles == 64) landing.uplink(test::do_edl());
        skipped += static_cast<std::uint64_t>(executive->ticks_skipped());
    }
    const double wall_s = std::chrono::duration<double>{clock::now() - began}.count();

    std::printf("%-24s %9s %8s %8s %8s %8s %8s %6s %7s %7s\n", "task, its messages", "times", "least us", "mean", "99.9 %", "worst",
                "budget", "ratio", "uneven", "stack");
    double together_us = 0.0;
    bool within = true;
    for (const server::TaskTimes& task : executive->times()) {
        print(task);
        together_us += task.cycle.worst_us();
        within = within && task.cycle.p999_us() <= flight::limits_of(task.module).budget_us;
    }
    const double tick_us = seconds_per_tick * 1.0e6;
    std::printf("\n%llu cycles in %.1f s; worst of all tasks together %.0f us of a cycle's %.0f us, ratio %.2f\n",
                static_cast<unsigned long long>(cycles), wall_s, together_us, tick_us, together_us / tick_us);
    std::printf("overruns that sync counted: %llu; ticks that passed in a cycle beyond its own: %llu\n",
                static_cast<unsigned long long>(landing.counters().overruns), static_cast<unsigned long long>(skipped));
    if (real_time)
        std::printf("lateness of a tick: mean %.0f us, 99.9 %% %.0f us, worst %.0f us\n", lateness.mean_us(), lateness.p999_us(),
                    lateness.worst_us());
    return within && together_us <= tick_us ? 0 : 1;
}
