#include "server/cli/commands.hpp"
#include "server/cli/shipped_paths.hpp"
#include "server/rehearsal/landing_report.hpp"
#include "server/rehearsal/pipeline_thread.hpp"
#include "server/rehearsal/rehearsal.hpp"
#include "server/rehearsal/wall_clock.hpp"
#include "server/scenario/script_check.hpp"

#include <chrono>
#include <fmt/format.h>
#include <memory>

namespace aeolis::server {
namespace {

constexpr std::size_t delivery_entries = 512; // ours: some 60 KB a hand-over

Result<std::unique_ptr<PipelineThread>> opened_archive(const std::filesystem::path& file,
                                                       const dictionary::Dictionary& dictionary) {
    std::error_code ignored;
    if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), ignored);
    auto archive = archive::Archive::open(file);
    if (!archive) return archive.error();
    auto pipeline = std::make_unique<PipelineThread>(std::move(*archive), dictionary, PipelineThread::Faults::give_up,
                                                     pipeline::Publish{});
    pipeline->want_items(false);
    return pipeline;
}

/// To the end, everything that reaches Earth into the archive.
Result<void> fly_archived(Rehearsal& rehearsal, PipelineThread& pipeline) {
    if (const auto run = pipeline.begin(rehearsal.run_start(0.0)); !run) return run.error();
    Delivery delivery;
    const auto hand_over = [&] {
        delivery.relay_progress = rehearsal.landing().relay_progress();
        return pipeline.deliver(std::exchange(delivery, {}));
    };
    while (!rehearsal.finished()) {
        delivery.add(rehearsal.step());
        for (auto& stage : rehearsal.take_stages())
            delivery.entries.emplace_back(std::move(stage));
        if (delivery.entries.size() >= delivery_entries && !hand_over()) return Error{pipeline.fault()};
    }
    if (!hand_over()) return Error{pipeline.fault()};
    return pipeline.finish({rehearsal.outcome(), rehearsal.outcome_reason(), rehearsal.digest(), wall_clock_text()});
}

} // namespace

int rehearse(const RehearseOptions& options) {
    const auto dictionary = dictionary_of_flight(options.shared.dictionary);
    if (!dictionary) return failed(dictionary.error().message);
    const auto scenario = scenario_given(options.scenario, options.shared.scenarios);
    if (!scenario) return failed(scenario.error().message);

    if (const auto script = check_script(*scenario, *dictionary); !script)
        return failed(options.scenario + ": " + script.error().message);

    std::unique_ptr<PipelineThread> pipeline;
    if (options.archive) {
        auto opened = opened_archive(*options.archive, *dictionary);
        if (!opened) return failed(opened.error().message);
        pipeline = std::move(*opened);
    }
    const auto began = std::chrono::steady_clock::now();
    Rehearsal rehearsal{*scenario, options.seed, options.case_number, *dictionary};
    if (pipeline) {
        if (const auto flown = fly_archived(rehearsal, *pipeline); !flown) return failed(flown.error().message);
    } else {
        while (!rehearsal.finished()) {
            rehearsal.step();
            rehearsal.take_stages();
        }
    }
    const double wall_s = std::chrono::duration<double>{std::chrono::steady_clock::now() - began}.count();
    if (options.json)
        fmt::print("{}\n", landing_json(rehearsal, wall_s));
    else
        fmt::print("{}", landing_table(rehearsal, wall_s));
    return rehearsal.outcome() == "touchdown" ? 0 : 1;
}

} // namespace aeolis::server
