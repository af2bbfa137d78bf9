// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/program_digest.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/long_work.hpp"
#include "server/cli/options.hpp"
#include "server/cluster/case_worker.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <memory>
#include <set>
#include <spdlog/spdlog.h>
#include <thread>
#include <unistd.h>

namespace aeolis::server {
namespace {

constexpr unsigned worker_jobs_max = 256;  // chosen: each holds a landing

struct WorkerOptions {
    SharedOptions shared;
    cluster::EngineAddress nats;
    cluster::WorkerSettings settings;
};

std::string name_of_this_process() {
    std::array<char, 256> host{};
    if (gethostname(host.data(), host.size() - 1) != 0) return fmt::format("worker-{}", getpid());
    return fmt::format("{}-{}", host.data(), getpid());
}

std::string progress_line(const cluster::WorkerProgress& progress) {
    const double rate_per_s = progress.wall_s > 0.0 ? static_cast<double>(progress.flown) / progress.wall_s : 0.0;
    auto text =
        fmt::format("{} cases flown, {:.2f} cases/s; {} campaigns", progress.flown, rate_per_s, progress.campaigns);
    if (!progress.waiting_for.empty()) text += "; " + progress.waiting_for;
    return text;
}

int run_worker(WorkerOptions options) {
    const auto dictionary = dictionary_of_flight(options.shared.dictionary);
    if (!dictionary) return failed(dictionary.error().message);
    if (options.settings.name.empty()) options.settings.name = name_of_this_process();
    if (options.settings.jobs == 0) options.settings.jobs = std::max(1U, std::thread::hardware_concurrency());
    auto program = campaign::program_digest();
    if (!program) return failed(program.error().message);
    campaign::Identity own;
    own.dictionary = fmt::format("{}", dictionary->id);
    own.program = std::move(*program);
    auto engine = cluster::Engine::connect(options.nats, "aeolis worker " + options.settings.name);
    if (!engine) return failed(engine.error().message);
    stop_at_interrupt();
    fmt::print("aeolis: worker {} flies cases of {}, {} at a time; end with Ctrl-C\n", options.settings.name,
               cluster::shown(options.nats), options.settings.jobs);
    std::fflush(stdout);
    ProgressLine line;
    std::set<std::string> told;  // each once
    std::string fault;
    const auto tell = [&](const cluster::WorkerProgress& progress) {
        for (const auto& why : progress.left_out)
            if (told.insert(why).second) spdlog::warn("not flown here: {}", why);
        if (progress.waiting_for != fault) {
            fault = progress.waiting_for;
            if (!fault.empty()) spdlog::warn("{}", fault);
        }
        line.draw(progress_line(progress));
    };
    const auto worked =
        cluster::work(*engine, own, cluster::landings(*dictionary, stop_asked()), options.settings, stop_asked(), tell);
    fmt::print("aeolis: worker {}: {}\n", options.settings.name, progress_line(worked));
    return 0;
}

}  // namespace

void add_worker_command(CLI::App& program, int& exit_code) {
    const auto options = std::make_shared<WorkerOptions>();
    options->settings.jobs = 0;
    auto& command = *program.add_subcommand(
        "worker", "flies the cases that campaigns of the same program put into a queue (campaign --nats)");
    add_engine(command, options->nats, "the NATS engine, nats://HOST:PORT")->required();
    command.add_option("--jobs", options->settings.jobs, "cases flown at a time; one per processor if left out")
        ->check(whole_number())
        ->check(CLI::Range(1U, worker_jobs_max));
    command.add_option("--name", options->settings.name, "name that the campaign shows; host and process if left out");
    add_shared(command, options->shared);
    command.callback([options, &exit_code] { exit_code = run_worker(*options); });
}

}  // namespace aeolis::server
