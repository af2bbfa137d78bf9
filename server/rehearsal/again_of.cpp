// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/again_of.hpp"

#include "server/archive/run_instant.hpp"

#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace aeolis::server {
namespace {

constexpr double cycles_max = 1.0e12;  // some five hundred years

}  // namespace

Result<archive::ForkPoint> fork_point_of(const v1::Fork& fork, const v1::RunState& run) {
    if (fork.at().empty()) return Error{"fork.at: an instant of the run is wanted, like E+3:10"};
    auto at = archive::instant_of(fork.at(), run, "fork.at");
    if (!at) return at.error();
    if (std::string_view{fork.at()}.starts_with(archive::ert_prefix))
        *at = *at + run.light_time_s();  // the vehicle has flown on since it sent what is received then
    const double cycles = std::round((*at - Sclk{run.start_sclk()}) / seconds_per_tick);
    if (cycles < 0.0)
        return Error{fmt::format("fork.at: {} is before run {} begins, at E{:+.0f} s", fork.at(), run.run(),
                                 run.start_sclk() - run.entry_sclk())};
    if (cycles > cycles_max) return Error{fmt::format("fork.at: {} is after all that a run can hold", fork.at())};
    const auto cycle = static_cast<std::uint64_t>(cycles);
    const double e_s = run.start_sclk() + cycles * seconds_per_tick - run.entry_sclk();
    return archive::ForkPoint{{static_cast<std::uint32_t>(run.run())}, cycle, e_s, fork.seed()};
}

Result<RehearsalRunner::Again> again_of(const v1::StartRehearsal& request, archive::Reader& reader) {
    const bool forks = request.has_fork();
    const std::string_view field = forks ? "fork" : "continue_run";
    if (request.has_inline_scenario() || !request.scenario().empty() || request.seed() != 0)
        return Error{fmt::format("{}: the run has its scenario and its seed; leave them out", field)};
    if (forks && request.continue_run() != 0) return Error{"fork and continue_run: one of them, not both"};
    const auto number = forks ? request.fork().run() : request.continue_run();
    if (number == 0 || number > std::numeric_limits<std::uint32_t>::max())
        return Error{fmt::format("{}: no run {}", field, number)};
    const archive::RunId id{static_cast<std::uint32_t>(number)};
    if (!forks) {
        auto cut = reader.cut_off(id);
        if (!cut) return cut.error();
        return RehearsalRunner::Again{std::move(*cut), {}, false};
    }
    const auto run = reader.run(id);
    if (!run) return run.error();
    auto flown = reader.flown(id);
    if (!flown) return flown.error();
    if (flown->scenario_text.empty())
        return Error{fmt::format("fork: run {} follows another mission: nothing can be flown again", id.value)};
    const auto at = fork_point_of(request.fork(), *run);
    if (!at) return at.error();
    return RehearsalRunner::Again{std::move(*flown), *at, request.fork().paused()};
}

}  // namespace aeolis::server
