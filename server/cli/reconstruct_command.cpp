// SPDX-License-Identifier: Apache-2.0
#include "server/archive/items.hpp"
#include "server/archive/reader.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/new_file.hpp"
#include "server/cli/options.hpp"
#include "server/cli/recorded_dictionary.hpp"
#include "server/cli/shipped_paths.hpp"
#include "server/reconstruction/density.hpp"
#include "server/reconstruction/path.hpp"
#include "server/reconstruction/trajectory_files.hpp"
#include "server/scenario/scenario_text.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace aeolis::server {
namespace {

using reconstruction::DensityPoint;
using reconstruction::Path;
using reconstruction::PathPoint;
using reconstruction::RecordedLanding;
using reconstruction::Vector3;

constexpr double degree_rad = std::numbers::pi / 180.0;
constexpr double metres_per_km = 1000.0;
constexpr double site_sigma_min_m = 0.1, site_sigma_max_m = 10'000.0;  // chosen
/// The events by which the summary tells of the path.
constexpr std::array moments{"GUIDANCE_START",       "PARACHUTE_DEPLOY", "HEATSHIELD_SEPARATION", "RADAR_LOCK",
                             "BACKSHELL_SEPARATION", "SKY_CRANE_START",  "ROVER_SEPARATION",      "TOUCHDOWN"};

struct ReconstructOptions {
    ArchiveOptions of;
    std::filesystem::path out;
    std::vector<double> site;  ///< latitude, longitude, radius; empty: not known
    double site_sigma_m = reconstruction::LandingSite{}.sigma_m;
};

CLI::Validator known_ending() {
    return {[](const std::string& file) {
                return file.ends_with(".csv") || reconstruction::trajectory_format_of(file)
                           ? std::string{}
                           : file + " ends neither in .csv nor in .oem, .aem, .bsp, .bc or .tsc";
            },
            "FILE"};
}

std::optional<reconstruction::LandingSite> site_of(const ReconstructOptions& options) {
    if (options.site.empty()) return std::nullopt;
    return reconstruction::LandingSite{options.site.at(0), options.site.at(1), options.site.at(2),
                                       options.site_sigma_m};
}

/// The octets of the rebuilt path as a trajectory, an attitude or a clock of the field's formats.
Result<std::string> trajectory_of(reconstruction::TrajectoryFormat format, const Path& path,
                                  const ClockCorrelation& clock) {
    std::vector<reconstruction::TimedState> states;
    states.reserve(path.points.size());
    for (const PathPoint& point : path.points) states.push_back({point.at, point.state});
    const auto created = std::chrono::duration_cast<std::chrono::microseconds>(
        std::chrono::system_clock::now() - std::chrono::sys_days{std::chrono::year{2000} / 1 / 1} -
        std::chrono::hours{12});
    return reconstruction::trajectory_file(format, states, clock, Scet{created.count()});
}

/// The vehicle as the run's scenario believes it to be; of a mission without a scenario the design.
Result<reconstruction::KnownVehicle> vehicle_of(archive::Reader& reader, archive::RunId run) {
    reconstruction::KnownVehicle vehicle;
    const auto text = reader.scenario_text(run);
    if (!text && text.error().internal) return text.error();
    if (!text) return vehicle;
    const auto scenario = scenario_from_text(*text, "the run's scenario");
    if (!scenario) return scenario.error();
    const simulation::Scenario believed = simulation::as_believed(*scenario);
    vehicle.entry_mass_kg = believed.masses.entry_kg;
    vehicle.balance_each_kg = believed.masses.entry_balance_each_kg;
    for (const simulation::AeroScale& row : believed.aero_scale) vehicle.drag_scale.push_back({row.mach, row.drag});
    return vehicle;
}

std::string csv_of(const Path& path, const std::vector<DensityPoint>& density) {
    std::string text =
        "e_s,sclk,p_x_m,p_y_m,p_z_m,v_x_mps,v_y_mps,v_z_mps,q_w,q_x,q_y,q_z,altitude_m,speed_mps,latitude_deg,"
        "longitude_deg,sigma_p_m,sigma_v_mps,sigma_attitude_deg,sigma_height_m,density_kgm3,sigma_density_kgm3\n";
    auto air = density.begin();
    for (const PathPoint& point : path.points) {
        const auto& [p, v, q] = point.state;
        const double radius_m = p.norm();
        text += fmt::format(
            "{:.6f},{:.6f},{:.3f},{:.3f},{:.3f},{:.5f},{:.5f},{:.5f},{:.9f},{:.9f},{:.9f},{:.9f},{:.3f},{:.5f},{:.7f},"
            "{:.7f},{:.3f},{:.5f},{:.6f},{:.3f},",
            point.at - path.entry, point.at.seconds, p.x(), p.y(), p.z(), v.x(), v.y(), v.z(), q.w(), q.x(), q.y(),
            q.z(), radius_m - path.target_radius_m, v.norm(), std::asin(p.z() / radius_m) / degree_rad,
            std::atan2(p.y(), p.x()) / degree_rad, point.sigma_p_m.norm(), point.sigma_v_mps.norm(),
            point.sigma_angle_rad.norm() / degree_rad, point.sigma_height_m);
        // The density of the step that ends with the point.
        while (air != density.end() && air->at < point.at + -reconstruction::path_step_s) ++air;
        text += air != density.end() && air->at < point.at
                    ? fmt::format("{:.5e},{:.3e}\n", air->density_kgm3, air->sigma_kgm3)
                    : std::string{",\n"};
    }
    return text;
}

void print_recorded(const RecordedLanding& recorded) {
    fmt::print("\n{:<22}{:>9}{:>12}{:>20}\n", "recorded packet", "packets", "octets", "most in a second");
    reconstruction::Recorded all;
    const auto row = [](const std::string& name, const reconstruction::Recorded& one) {
        std::uint64_t most = 0;
        for (const auto& [second, octets] : one.octets_in) most = std::max(most, octets);
        fmt::print("{:<22}{:>9}{:>12}{:>20}\n", name, one.packets, one.octets, most);
    };
    for (const auto& [name, one] : recorded.packets()) {
        row(name, one);
        all.packets += one.packets;
        all.octets += one.octets;
        for (const auto& [second, octets] : one.octets_in) all.octets_in[second] += octets;
    }
    row("all", all);
}

void print_path(const Path& path, const RecordedLanding& recorded) {
    fmt::print("\n{:<22}{:>9}{:>11}{:>10}{:>10}{:>9}{:>10}   {}\n", "path at", "E+ s", "altitude m", "speed m/s", "+-m",
               "+-m/s", "+-deg", "navigated less rebuilt: m, m/s, deg");
    const auto row = [&](const char* name, Sclk at) {
        const auto point = std::ranges::lower_bound(path.points, at, {}, &PathPoint::at);
        const PathPoint& shown = point == path.points.end() ? path.points.back() : *point;
        if (std::abs(shown.at - at) > 2.0 * reconstruction::path_step_s)
            return fmt::print("{:<22}{:>9.2f}   the path does not cover it\n", name, at - path.entry);
        const auto& [p, v, q] = shown.state;
        fmt::print("{:<22}{:>9.2f}{:>11.1f}{:>10.2f}{:>10.1f}{:>9.3f}{:>10.4f}", name, shown.at - path.entry,
                   p.norm() - path.target_radius_m, v.norm(), shown.sigma_p_m.norm(), shown.sigma_v_mps.norm(),
                   shown.sigma_angle_rad.norm() / degree_rad);
        if (shown.navigated)
            fmt::print("   {:.1f}, {:.3f}, {:.4f}", (shown.navigated->p_MoB_M - p).norm(),
                       (shown.navigated->v_MB_M - v).norm(), q.angularDistance(shown.navigated->q_MB) / degree_rad);
        fmt::print("\n");
    };
    row("(begins)", path.points.front().at);
    row("(entry)", path.entry);
    for (const char* name : moments)
        if (const auto at = recorded.reported(name)) row(name, *at);
}

void print_density(const std::vector<DensityPoint>& density) {
    if (density.empty()) return;
    fmt::print("\n{:<22}{:>14}{:>14}{:>8}{:>8}\n", "density by drag", "altitude km", "kg/m3", "+-%", "Mach");
    constexpr double every_m = 10'000.0, percent = 100.0;
    double next_m = std::floor(density.front().altitude_m / every_m) * every_m;
    const auto row = [](const char* name, const DensityPoint& point) {
        fmt::print("{:<22}{:>14.2f}{:>14.4e}{:>8.1f}{:>8.2f}\n", name, point.altitude_m / metres_per_km,
                   point.density_kgm3, percent * point.sigma_kgm3 / point.density_kgm3, point.mach);
    };
    row("(first known)", density.front());
    for (const DensityPoint& point : density) {
        if (point.altitude_m > next_m) continue;
        row("", point);
        next_m -= every_m;
    }
    row("(last known)", density.back());
}

int reconstruct(const ReconstructOptions& options) {
    int exit_code = 0;
    const auto said = [](const Error& error) { return failed("reconstruct: " + error.message); };
    if (!options.out.empty())
        if (const auto possible = can_be_made(options.out); !possible) return said(possible.error());
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
    const auto path = reconstruction::reconstruct(*recorded, {}, site_of(options));
    if (!path) return said(path.error());
    const auto vehicle = vehicle_of(*reader, run);
    if (!vehicle) return said(vehicle.error());
    const auto density = reconstruction::density_along(*path, *recorded, *vehicle);
    if (!options.out.empty()) {
        const auto format = reconstruction::trajectory_format_of(options.out.string());
        const auto octets = format ? trajectory_of(*format, *path, archive::correlation_of(*state))
                                   : Result<std::string>{csv_of(*path, density)};
        if (!octets) return said(octets.error());
        if (const auto made = make_file(options.out, *octets); !made) return said(made.error());
    }
    fmt::print("Run {}: {}, seed {}, {}\n", state->run(), state->scenario(), state->seed(),
               v1::Landing::Outcome_Name(state->outcome()));
    print_recorded(*recorded);
    print_path(*path, *recorded);
    print_density(density);
    const Vector3& bias = path->accelerometer_bias_mps2;
    fmt::print(
        "\n{} readings of the IMU, {} missing and filled, {} gaps; {} readings of radar beams taken, {} refused. "
        "Accelerometers' bias {:.2e}, {:.2e}, {:.2e} m/s2.\n"
        "+-: one standard deviation, of the three axes together. Times are those of the vehicle's clock, from the "
        "entry that ground's last parameters state.\n",
        path->readings, path->readings_filled, path->breaks, path->beams_taken, path->beams_refused, bias.x(), bias.y(),
        bias.z());
    if (options.site.empty())
        fmt::print("The place is known by navigation at entry only: --site says where the rover stands.\n");
    if (options.out.empty()) return 0;
    if (reconstruction::trajectory_format_of(options.out.string()) == reconstruction::TrajectoryFormat::sclk)
        fmt::print("The run's clock is in {}\n", options.out.string());
    else
        fmt::print("{} points are in {}\n", path->points.size(), options.out.string());
    return 0;
}

}  // namespace

void add_reconstruct_command(CLI::App& program, int& exit_code) {
    const auto options = std::make_shared<ReconstructOptions>();
    auto& command = *program.add_subcommand(
        "reconstruct", "rebuilds the path of a landing from its recording alone: position, velocity and attitude from "
                       "entry to touchdown, with their standard deviations");
    add_archive_file(command, options->of.archive);
    command.add_option("--dictionary", options->of.shared.dictionary, "directory of the mission's dictionary")
        ->capture_default_str();
    command.add_option("--run", options->of.run, "number of the run")->required()->check(whole_number());
    command
        .add_option("--out", options->out,
                    "write the path, eight states a second, to this new file, by its ending: .csv, .oem, .aem (CCSDS), "
                    ".bsp, .bc, .tsc (SPICE)")
        ->check(known_ending());
    auto& site =
        *command
             .add_option("--site", options->site,
                         "where the rover stands: areocentric latitude and east longitude in degrees, radius of "
                         "the ground in metres")
             ->expected(3)
             ->check(CLI::Number);
    command.add_option("--site-sigma", options->site_sigma_m, "one standard deviation of that place, in metres")
        ->check(CLI::Range(site_sigma_min_m, site_sigma_max_m))
        ->needs(&site)
        ->capture_default_str();
    command.callback([options, &exit_code] { exit_code = reconstruct(*options); });
}

}  // namespace aeolis::server
