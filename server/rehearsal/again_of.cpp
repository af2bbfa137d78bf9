// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/again_of.hpp"

#include "server/archive/items.hpp"
#include "server/archive/run_instant.hpp"
#include "server/scenario/scenario_text.hpp"

#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace aeolis::server {
namespace {

constexpr double cycles_max = 1.0e12;  // some five hundred years

}  // namespace

Result<archive::ForkPoint> fork_point_of(const v1::Fork& fork, const v1::RunState& run, std::string_view name) {
    if (fork.at().empty()) return Error{fmt::format("{}: an instant of the run is wanted, like E+3:10", name)};
    auto at = archive::instant_of(fork.at(), run, name);
    if (!at) return at.error();
    if (std::string_view{fork.at()}.starts_with(archive::ert_prefix))
        *at = *at + run.light_time_s();  // the vehicle has flown on since it sent what is received then
    const double cycles = std::round((*at - Sclk{run.start_sclk()}) / seconds_per_tick);
    if (cycles < 0.0)
        return Error{fmt::format("{}: {} is before run {} begins, at E{:+.0f} s", name, fork.at(), run.run(),
                                 run.start_sclk() - run.entry_sclk())};
    if (cycles > cycles_max) return Error{fmt::format("{}: {} is after all that a run can hold", name, fork.at())};
    const auto cycle = static_cast<std::uint64_t>(cycles);
    const double e_s = run.start_sclk() + cycles * seconds_per_tick - run.entry_sclk();
    return archive::ForkPoint{{static_cast<std::uint32_t>(run.run())}, cycle, e_s, fork.seed()};
}

namespace {

/// When Earth has received what the run has at that instant.
Ert ert_of(const v1::RunState& run, const archive::ForkPoint& at) {
    const auto flown_s = static_cast<double>(at.cycle) * seconds_per_tick;
    return {archive::correlation_of(run).scet_of(Sclk{run.start_sclk()} + flown_s).microseconds};
}

/// The ERT of a run's last item; none: it has no item.
Result<std::optional<Ert>> last_ert(archive::Reader& reader, archive::RunId id) {
    const auto last = reader.last_seq(id);
    if (!last) return last.error();
    if (*last == 0) return std::optional<Ert>{};
    const auto page = reader.items(id, *last - 1, 1);
    if (!page) return page.error();
    if (page->items.empty()) return std::optional<Ert>{};
    return std::optional{Ert{page->items.back().ert_us()}};
}

constexpr std::int64_t second_us = 1'000'000;

/// A fork that was cut off before its instant has neither its parent's later requests nor what people added to it.
Result<void> check_cut_off_after_fork(archive::Reader& reader, const v1::RunState& run, const archive::FlownRun& cut) {
    if (!cut.forked_from) return {};
    const auto last = last_ert(reader, cut.run);
    if (!last) return last.error();
    if (*last && last->value().microseconds >= ert_of(run, *cut.forked_from).microseconds) return {};
    return Error{
        fmt::format("continue_run: run {} was cut off before it had come to its fork, at E{:+.1f} s; fork run {} "
                    "again instead",
                    cut.run.value, cut.forked_from->e_s, cut.forked_from->run.value)};
}

/// Whether the errors that a seed of the fork's own would draw anew have been drawn by then.
Result<void> check_seed(const archive::FlownRun& run, const archive::ForkPoint& at) {
    if (at.seed == 0) return {};
    const auto scenario = scenario_from_text(run.scenario_text, fmt::format("the scenario of run {}", run.run.value));
    if (!scenario) return scenario.error();
    if (!scenario->disperse_before_entry_s || at.e_s >= -*scenario->disperse_before_entry_s) return {};
    return Error{
        fmt::format("fork.seed: the errors of run {} are drawn {} s before entry, by its own seed; fork it later, "
                    "or start another run",
                    run.run.value, *scenario->disperse_before_entry_s)};
}

}  // namespace

Result<void> check_flown(archive::Reader& reader, const v1::RunState& run, const archive::ForkPoint& at,
                         std::string_view name) {
    const auto last = last_ert(reader, archive::RunId{static_cast<std::uint32_t>(run.run())});
    if (!last) return last.error();
    if (!*last) return Error{fmt::format("{}: run {} has nothing recorded", name, run.run())};
    if (ert_of(run, at).microseconds <= last->value().microseconds + second_us) return {};
    const auto end = archive::correlation_of(run).sclk_of(Scet{last->value().microseconds});
    return Error{fmt::format("{}: E{:+.1f} s is after the record of run {} ends, at E{:+.1f} s", name, at.e_s,
                             run.run(), end.seconds - run.entry_sclk())};
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
        const auto state = reader.run(id);
        if (!state) return state.error();
        if (const auto after = check_cut_off_after_fork(reader, *state, *cut); !after) return after.error();
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
    if (const auto reached = check_flown(reader, *run, *at, "fork.at"); !reached) return reached.error();
    if (const auto drawn = check_seed(*flown, *at); !drawn) return drawn.error();
    return RehearsalRunner::Again{std::move(*flown), *at, request.fork().paused()};
}

}  // namespace aeolis::server
