// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/api/plan_state.hpp"
#include "server/archive/reader.hpp"
#include "server/rehearsal/again_of.hpp"
#include "server/rehearsal/rehearsal_runner.hpp"
#include "server/scenario/scenario_text.hpp"
#include "tests/server/running_server.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/temporary_folder.hpp"

#include <atomic>
#include <fmt/format.h>
#include <functional>
#include <spdlog/spdlog.h>
#include <thread>

namespace aeolis::test {

inline const std::filesystem::path shipped_dictionary_folder = AEOLIS_SOURCE_DIR "/dictionaries/msl";

/// The plan of this text, which stands in p.yaml.
inline server::PlannedInjects plan_of_text(const std::string& text) {
    auto read = server::instruction::read_plan(text, "p.yaml", tests::shipped_dictionary(), {}, {});
    INFO(read.findings_text());
    REQUIRE(read.plan);
    v1::InstructorPlan given;
    given.set_name("p.yaml");
    given.set_text(text);
    return {std::move(given), std::move(*read.plan)};
}
inline server::PlannedInjects shipped_plan(const char* name) {
    auto given =
        server::instruction::PlanLibrary{shipped_dictionary_folder, tests::shipped_dictionary()}.plan(name).value();
    auto read = server::instruction::read_plan(given, tests::shipped_dictionary());
    REQUIRE(read.plan);
    return {std::move(given), std::move(*read.plan)};
}

/// An archive in which runs are flown, one after another.
class InstructedRuns {
  public:
    /// Flies until E+`until_e_s`, where the run is left as by a crash or, without a number, to its end.
    /// `meanwhile` is called once it has begun.
    std::string
    fly(const std::function<std::unique_ptr<server::RehearsalRunner>(server::PipelineThread&,
                                                                     server::RehearsalRunner::Callbacks)>& make,
        std::optional<double> until_e_s, const std::function<void(server::RehearsalRunner&)>& meanwhile = {}) {
        spdlog::set_level(spdlog::level::off);
        server::PipelineThread pipeline{std::move(archive::Archive::open(file_)).value(), tests::shipped_dictionary(),
                                        server::PipelineThread::Faults::give_up, [](const auto&) {}};
        std::atomic<bool> begun{false};
        std::atomic<double> e_s{-1.0e9};
        std::string failure;
        server::RehearsalRunner::Callbacks callbacks;
        callbacks.on_begun = [&](const Result<v1::RunState>& state) {
            if (!state) failure = state.error().message;
            begun = true;
        };
        callbacks.on_state = [](const auto&) {};
        callbacks.on_clocks = [&](const v1::Clocks& clocks) { e_s = clocks.e_s(); };
        const auto runner = make(pipeline, callbacks);
        while (!begun) std::this_thread::sleep_for(std::chrono::milliseconds{1});
        if (!failure.empty()) return failure;
        if (meanwhile) meanwhile(*runner);
        while (!runner->over() && !(until_e_s && e_s >= *until_e_s))
            std::this_thread::sleep_for(std::chrono::milliseconds{1});
        return failure;
    }
    std::string fly_new(const std::optional<server::PlannedInjects>& plan, std::optional<double> until_e_s,
                        const std::function<void(server::RehearsalRunner&)>& meanwhile = {}, double pace = 0.0) {
        return fly(
            [&](server::PipelineThread& pipeline, server::RehearsalRunner::Callbacks callbacks) {
                return std::make_unique<server::RehearsalRunner>(short_landing(), 7, pace, tests::shipped_dictionary(),
                                                                 pipeline, std::move(callbacks), plan);
            },
            until_e_s, meanwhile);
    }
    std::string fly_again(const v1::StartRehearsal& request) {
        REQUIRE(archive::Archive::open(file_).ok());  // as a server that comes up: what was cut off is marked so
        auto from = reader();
        auto again = server::again_of(request, from);
        if (!again) return again.error().message;
        auto scenario = server::scenario_from_text(again->run.scenario_text, "its row");
        REQUIRE(scenario);
        return fly(
            [&](server::PipelineThread& pipeline, server::RehearsalRunner::Callbacks callbacks) {
                return std::make_unique<server::RehearsalRunner>(
                    *scenario, std::move(*again), 0.0, tests::shipped_dictionary(), pipeline, std::move(callbacks));
            },
            {});
    }

    archive::Reader reader() const {
        return std::move(archive::Reader::open(file_, tests::shipped_dictionary())).value();
    }
    /// "early done -840.0", a line each; of what waits only "waiting".
    std::string told(archive::RunId run) const {
        auto from = reader();
        const server::instruction::PlanLibrary none{{}, tests::shipped_dictionary()};
        const auto state = server::plan_state(from, run, tests::shipped_dictionary(), none);
        REQUIRE(state);
        std::string all;
        for (const auto& inject : state->injects())
            all += inject.inject() + ' ' + v1::PlannedInject::State_Name(inject.state()) +
                   (inject.has_e_s() ? fmt::format(" {:.1f}", inject.e_s()) : "") + '\n';
        return all;
    }
    std::size_t interventions(archive::RunId run) const {
        auto from = reader();
        return server::all_interventions(from, run).value().size();
    }

  private:
    TemporaryFolder folder_;
    std::filesystem::path file_ = folder_ / "a.db";
};

}  // namespace aeolis::test
