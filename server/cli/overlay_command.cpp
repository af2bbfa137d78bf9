// SPDX-License-Identifier: Apache-2.0
#include "server/archive/items.hpp"
#include "server/archive/reader.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/new_file.hpp"
#include "server/cli/options.hpp"
#include "server/cli/recorded_dictionary.hpp"
#include "server/cli/shipped_paths.hpp"
#include "server/reconstruction/path.hpp"
#include "server/reconstruction/recorded_landing.hpp"
#include "server/reconstruction/trajectory_files.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

namespace aeolis::server {
namespace {

using reconstruction::ForeignTrajectory;
using reconstruction::Navigated;
using reconstruction::RecordedLanding;
using reconstruction::Residual;

/// The events by which the table tells of residuals.
constexpr std::array overlay_moments{"GUIDANCE_START", "PARACHUTE_DEPLOY", "HEATSHIELD_SEPARATION",
                                     "BACKSHELL_SEPARATION", "TOUCHDOWN"};

struct OverlayOptions {
    ArchiveOptions of;
    std::filesystem::path with, out;
    bool by_entry = false;  ///< times count from each one's own entry
    bool rebuilt = false;   ///< the path by reconstruction, not by flight's navigation
};

struct OverlaidPoint {
    Sclk at;
    Residual off;
};

Result<ForeignTrajectory> read_trajectory(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return Error{file.string() + " is not there"};
    if (std::filesystem::is_directory(file, ignored)) return Error{file.string() + " is a folder, not a trajectory"};
    std::ifstream from{file, std::ios::binary};
    if (!from) return Error{file.string() + " cannot be read"};
    const std::vector<std::uint8_t> octets{std::istreambuf_iterator<char>{from}, {}};
    auto read = ForeignTrajectory::read(octets);
    if (!read) return Error{file.string() + ": " + read.error().message};
    return read;
}

/// When the navigated states come down to the radius of entry interface.
std::optional<Sclk> flown_entry(const std::vector<Navigated>& path, double radius_m) {
    for (std::size_t i = 1; i < path.size(); ++i) {
        const double before = path[i - 1].state.p_MoB_M.norm() - radius_m,
                     now = path[i].state.p_MoB_M.norm() - radius_m;
        if (before < 0.0 || now >= 0.0) continue;
        return path[i - 1].at + before / (before - now) * (path[i].at - path[i - 1].at);
    }
    return std::nullopt;
}

std::string residuals_csv(const std::vector<OverlaidPoint>& points, Sclk entry) {
    std::string text = "e_s,sclk,up_m,along_m,right_m,speed_mps\n";
    for (const auto& [at, off] : points)
        text += fmt::format("{:.6f},{:.6f},{:.3f},{:.3f},{:.3f},{:.5f}\n", at - entry, at.seconds, off.up_m,
                            off.along_m, off.right_m, off.speed_mps);
    return text;
}

/// The point next to an instant; none within a second.
const OverlaidPoint* point_at(const std::vector<OverlaidPoint>& points, Sclk at) {
    constexpr double apart_max_s = 1.0;
    const auto nearest =
        std::ranges::min_element(points, {}, [&](const auto& point) { return std::abs(point.at - at); });
    return nearest != points.end() && std::abs(nearest->at - at) <= apart_max_s ? &*nearest : nullptr;
}

void print_residuals(const std::vector<OverlaidPoint>& points, const RecordedLanding& recorded, Sclk entry) {
    fmt::print("\n{:<24}{:>9}{:>11}{:>11}{:>11}{:>12}\n", "flown less the file", "E+ s", "up m", "along m", "right m",
               "speed m/s");
    const auto row = [&](const char* name, const OverlaidPoint& point) {
        fmt::print("{:<24}{:>9.2f}{:>11.1f}{:>11.1f}{:>11.1f}{:>12.3f}\n", name, point.at - entry, point.off.up_m,
                   point.off.along_m, point.off.right_m, point.off.speed_mps);
    };
    row("(first in both)", points.front());
    for (const char* name : overlay_moments) {
        const auto at = recorded.reported(name);
        if (const auto* point = at ? point_at(points, *at) : nullptr) row(name, *point);
    }
    row("(last in both)", points.back());
    const auto size_of = [](const Residual& off) { return std::hypot(off.up_m, off.along_m, off.right_m); };
    double squares = 0.0;
    for (const auto& point : points) squares += size_of(point.off) * size_of(point.off);
    const auto& largest = *std::ranges::max_element(points, {}, [&](const auto& point) { return size_of(point.off); });
    fmt::print("\n{} states compared. Apart: {:.1f} m root mean square, {:.1f} m at most, at E{:+.2f} s.\n",
               points.size(), std::sqrt(squares / static_cast<double>(points.size())), size_of(largest.off),
               largest.at - entry);
}

int overlay(const OverlayOptions& options) {
    int exit_code = 0;
    const auto said = [](const Error& error) { return failed("overlay: " + error.message); };
    if (!options.out.empty())
        if (const auto possible = can_be_made(options.out); !possible) return said(possible.error());
    const auto other = read_trajectory(options.with);
    if (!other) return said(other.error());
    const auto with = recorded_dictionary(options.of.shared.dictionary, {}, exit_code);
    if (!with) return exit_code;
    auto reader = archive::Reader::open(options.of.archive, with->dictionary);
    if (!reader) return said(reader.error());
    const archive::RunId run{options.of.run.value_or(0)};
    const auto state = reader->run(run);
    if (!state) return said(state.error());
    auto recorded = RecordedLanding::with(with->dictionary);
    if (!recorded) return said(recorded.error());
    const auto read = reader->each_recorded_packet(run, [&](auto packet) { recorded->add(packet); });
    if (!read) return said(read.error());
    auto path = recorded->navigated();
    if (options.rebuilt) {
        const auto rebuilt = reconstruction::reconstruct(*recorded);
        if (!rebuilt) return said(rebuilt.error());
        path.clear();
        path.reserve(rebuilt->points.size());
        for (const auto& point : rebuilt->points) path.push_back({point.at, point.state});
    }
    if (path.empty()) return said({fmt::format("run {} has no recording of what was navigated yet", run.value)});
    const auto clock = archive::correlation_of(*state);
    const double radius_m = flight::build_parameters.entry_radius_m;
    const auto entry = flown_entry(path, radius_m);
    const Sclk from = entry.value_or(Sclk{state->entry_sclk()});
    double shift_s = 0.0;  // from the run's time to the file's
    if (options.by_entry) {
        const auto theirs = other->reaches(radius_m);
        if (!entry || !theirs)
            return said({fmt::format("{} does not come down to entry interface, radius {:.1f} km",
                                     entry ? options.with.string() : "the navigated path", radius_m / 1000.0)});
        shift_s = *theirs - ephemeris_time_of(clock.scet_of(*entry));
    }
    std::vector<OverlaidPoint> points;
    for (const Navigated& point : path)
        if (const auto theirs = other->at(ephemeris_time_of(clock.scet_of(point.at)) + shift_s))
            points.push_back({point.at, reconstruction::residual_of(point.state, *theirs)});
    if (points.empty())
        return said({fmt::format("the run is of {} to {}, the file of {} to {}: no instant is in both (--by-entry "
                                 "compares from entry to entry)",
                                 calendar_text(ephemeris_time_of(clock.scet_of(path.front().at)), TimeSystem::utc),
                                 calendar_text(ephemeris_time_of(clock.scet_of(path.back().at)), TimeSystem::utc),
                                 calendar_text(other->start(), TimeSystem::utc),
                                 calendar_text(other->stop(), TimeSystem::utc))});
    fmt::print("Run {}: {}, seed {}, over {}{}\n", state->run(), state->scenario(), state->seed(),
               options.with.string(),
               options.by_entry ? fmt::format(", from entry to entry ({:+.3f} s)", shift_s) : "");
    print_residuals(points, *recorded, from);
    if (options.out.empty()) return 0;
    if (const auto written = make_file(options.out, residuals_csv(points, from)); !written)
        return said(written.error());
    fmt::print("{} residuals are in {}\n", points.size(), options.out.string());
    return 0;
}

}  // namespace

void add_overlay_command(CLI::App& program, int& exit_code) {
    const auto options = std::make_shared<OverlayOptions>();
    auto& command = *program.add_subcommand("overlay", "compares what a run navigated, or its rebuilt path, with a "
                                                       "trajectory of someone else's: an orbit ephemeris of CCSDS or a "
                                                       "SPICE kernel of the types 9 and 13");
    add_archive_file(command, options->of.archive);
    command.add_option("--dictionary", options->of.shared.dictionary, "directory of the mission's dictionary")
        ->capture_default_str();
    command.add_option("--run", options->of.run, "number of the run")->required()->check(whole_number());
    command.add_option("--with", options->with, "the trajectory: OEM or SPK")->required();
    command.add_flag(
        "--by-entry", options->by_entry,
        "compare from entry interface to entry interface, not by the instant: for a rehearsal of another day");
    command.add_flag("--rebuilt", options->rebuilt,
                     "compare the path as reconstruct rebuilds it, not what flight navigated");
    command.add_option("--out", options->out, "write every residual to this new CSV file");
    command.callback([options, &exit_code] { exit_code = overlay(*options); });
}

}  // namespace aeolis::server
