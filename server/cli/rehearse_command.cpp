// SPDX-License-Identifier: Apache-2.0
#include "server/base/wall_clock.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/options.hpp"
#include "server/cli/shipped_paths.hpp"
#include "server/pipeline/pipeline_thread.hpp"
#include "server/rehearsal/landing_report.hpp"
#include "server/rehearsal/rehearsal.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <memory>
#include <numbers>

namespace aeolis::server {
namespace {

struct RehearseOptions {
    SharedOptions shared;
    std::string scenario;
    std::uint64_t seed = 1, case_number = 0;
    std::optional<std::filesystem::path> archive;
    std::optional<std::filesystem::path> truth;  ///< CSV of the truth, 16 rows a second
    bool json = false;
};

constexpr std::size_t delivery_entries = 512;  // chosen: about 60 KB each

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

/// The true state, one row per fourth cycle until standstill, for plots.
class TruthFile {
  public:
    Result<void> open(const std::filesystem::path& file) {
        file_ = file;
        rows_.open(file, std::ios::binary);
        rows_ << "e_s,altitude_m,speed_mps,flight_path_deg,latitude_deg,longitude_deg,sensed_mps2,bank_deg,angle_of_"
                 "attack_deg,"
                 "mach,dynamic_pressure_Pa,thrust_N,mass_kg,density_kgm3\n";
        return state();
    }
    void add(const simulation::Landing& landing) {
        if (!rows_.is_open() || landing.outcome() != simulation::Outcome::running) return;
        const simulation::TruthState truth = landing.truth();
        if (truth.sclk.ticks() % 4 != 0) return;
        const simulation::Inspection seen = landing.inspect();
        const auto& p = truth.p_MoB_M_m;
        const auto& v = truth.v_MB_M_mps;
        const double radius_m = std::hypot(p[0], p[1], p[2]);
        const double climb_mps = (v[0] * p[0] + v[1] * p[1] + v[2] * p[2]) / radius_m;
        constexpr double degree = std::numbers::pi / 180.0;
        rows_ << fmt::format(
            "{:.6f},{:.3f},{:.4f},{:.4f},{:.6f},{:.6f},{:.4f},{:.3f},{:.3f},{:.4f},{:.3f},{:.1f},{:.3f},{:.6e}\n",
            truth.e_s, truth.altitude_m, truth.speed_mps,
            std::asin(std::clamp(climb_mps / truth.speed_mps, -1.0, 1.0)) / degree, std::asin(p[2] / radius_m) / degree,
            std::atan2(p[1], p[0]) / degree, truth.sensed_mps2, seen.bank_deg, seen.angle_of_attack_deg, seen.mach,
            seen.dynamic_pressure_Pa, seen.thrust_N, seen.mass_kg, seen.density_kgm3);
    }
    Result<void> close() {
        if (rows_.is_open()) rows_.close();
        return state();
    }

  private:
    Result<void> state() const {
        if (rows_.fail()) return Error{file_.string() + ": cannot be written"};
        return {};
    }

    std::filesystem::path file_;
    std::ofstream rows_;
};

/// Flies to the end; everything that reaches Earth goes to the archive.
Result<void> fly_archived(Rehearsal& rehearsal, TruthFile& truth, PipelineThread& pipeline) {
    if (const auto run = pipeline.begin(rehearsal.run_start(0.0)); !run) return run.error();
    Delivery delivery;
    const auto hand_over = [&] {
        delivery.relay_progress = rehearsal.recording_progress();
        return pipeline.deliver(std::exchange(delivery, {}));
    };
    while (!rehearsal.finished()) {
        delivery.add(std::move(rehearsal.step()));
        delivery.pass(rehearsal.cycles(), rehearsal.landing().ert_now());
        truth.add(rehearsal.landing());
        for (auto& stage : rehearsal.take_stages()) delivery.entries.emplace_back(std::move(stage));
        if (delivery.entries.size() >= delivery_entries && !hand_over()) return Error{pipeline.fault()};
    }
    delivery.links = rehearsal.link_totals();
    if (!hand_over()) return Error{pipeline.fault()};
    return pipeline.finish({rehearsal.outcome(), rehearsal.outcome_reason(), rehearsal.digest(), wall_clock_text()});
}

int rehearse(const RehearseOptions& options) {
    const auto ready = flight_inputs(options.shared, options.scenario);
    if (!ready) return failed(ready.error().message);
    const auto& [dictionary, scenario] = *ready;
    std::unique_ptr<PipelineThread> pipeline;
    if (options.archive) {
        auto opened = opened_archive(*options.archive, dictionary);
        if (!opened) return failed(opened.error().message);
        pipeline = std::move(*opened);
    }
    TruthFile truth;
    for (const auto& other : {std::optional{std::filesystem::path{options.scenario}}, options.archive})
        if (std::error_code none; options.truth && other && std::filesystem::equivalent(*options.truth, *other, none))
            return failed(fmt::format("--truth: {} would be overwritten", options.truth->string()));
    if (options.truth)
        if (const auto opened = truth.open(*options.truth); !opened) return failed(opened.error().message);
    const auto began = std::chrono::steady_clock::now();
    Rehearsal rehearsal{scenario, options.seed, options.case_number, dictionary};
    if (pipeline) {
        if (const auto flown = fly_archived(rehearsal, truth, *pipeline); !flown) return failed(flown.error().message);
    } else {
        while (!rehearsal.finished()) {
            rehearsal.step();
            rehearsal.take_stages();
            truth.add(rehearsal.landing());
        }
    }
    const double wall_s = std::chrono::duration<double>{std::chrono::steady_clock::now() - began}.count();
    if (const auto written = truth.close(); !written) return failed(written.error().message);
    if (options.json)
        fmt::print("{}\n", landing_json(rehearsal, wall_s));
    else
        fmt::print("{}", landing_table(rehearsal, wall_s));
    return rehearsal.judgement().verdict == simulation::Verdict::landed ? 0 : 1;
}

}  // namespace

void add_rehearse_command(CLI::App& program, int& exit_code) {
    const auto options = std::make_shared<RehearseOptions>();
    auto& command = *program.add_subcommand("rehearse", "flies one landing without a console, as fast as it goes");
    command.add_option("--scenario", options->scenario, "a file, or the name of a shipped one")->required();
    command.add_option("--seed", options->seed, "seed of the errors")->check(whole_number())->capture_default_str();
    command.add_option("--case", options->case_number, "number of another draw of the errors under the same seed")
        ->check(whole_number())
        ->capture_default_str();
    command.add_option("--archive", options->archive, "store everything in this SQLite file");
    command.add_option("--truth", options->truth, "write the true path, 16 rows a second, to this CSV file");
    command.add_flag("--json", options->json, "print one JSON object");
    add_shared(command, options->shared);
    command.callback([options, &exit_code] { exit_code = rehearse(*options); });
}

}  // namespace aeolis::server
