// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/campaign_report.hpp"
#include "server/campaign/case_hdf5.hpp"
#include "server/campaign/sensitivity.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/long_work.hpp"
#include "server/cli/new_file.hpp"
#include "server/cli/options.hpp"
#include "server/cli/shipped_paths.hpp"
#include "server/cli/study.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <tuple>

namespace aeolis::server {
namespace {

int export_cases(const std::filesystem::path& file, const std::filesystem::path& csv,
                 const std::filesystem::path& hdf5) {
    const auto said = [](const Error& error) { return failed("campaign: " + error.message); };
    for (const auto& out : {csv, hdf5})
        if (!out.empty())
            if (const auto possible = can_be_made(out); !possible) return said(possible.error());
    const auto table = table_of(file);
    if (!table) return said(table.error());
    const auto make = [&](const std::filesystem::path& out, const std::string& octets) -> Result<void> {
        if (const auto made = make_file(out, octets); !made) return made;
        fmt::print("{} cases, {} quantities of each are in {}\n", table->numbers.size(), table->columns.size(),
                   out.string());
        return {};
    };
    if (!csv.empty())
        if (const auto made = make(csv, campaign::csv_of(*table)); !made) return said(made.error());
    if (hdf5.empty()) return 0;
    const auto header = campaign::results_header(file);
    if (!header) return said(header.error());
    const auto octets = campaign::hdf5_of(*table, {header->scenario, header->seed});
    if (!octets) return said(octets.error());
    if (const auto made = make(hdf5, *octets); !made) return said(made.error());
    return 0;
}

int correlate(const std::filesystem::path& file, const std::vector<std::string>& figures, std::size_t most) {
    const auto table = table_of(file);
    if (!table) return failed("campaign: " + table.error().message);
    for (const std::string& figure : figures)
        if (table->column(figure) == nullptr)
            return failed(fmt::format("campaign: {} has no quantity '{}'", file.string(), figure));
    const auto all = campaign::correlations(*table, figures);
    if (all.empty())
        return failed(fmt::format("campaign: {} has too few cases, or no errors were drawn", file.string()));
    fmt::print("{:<28}{:<30}{:>8}{:>14}{:>8}\n", "figure", "error drawn", "r", "by 1 sigma", "cases");
    std::string of;
    std::size_t shown = 0;
    double by_chance = 0.0;
    for (const auto& one : all) {
        if (one.figure != of) shown = 0;
        by_chance = std::max(by_chance, one.by_chance);
        if (++shown > most) continue;
        fmt::print("{:<28}{:<30}{:>8.3f}{:>14.5g}{:>8}{}\n", one.figure == of ? "" : one.figure, one.draw, one.r,
                   one.slope, one.cases, std::abs(one.r) < one.by_chance ? "  (chance)" : "");
        of = one.figure;
    }
    fmt::print("r: Pearson's. By chance alone |r| is below {:.3f} in 997 of 1000.\n", by_chance);
    return 0;
}

int compare(const std::filesystem::path& a, const std::filesystem::path& b, bool all) {
    const auto of_a = table_of(a);
    if (!of_a) return failed("campaign: " + of_a.error().message);
    const auto of_b = table_of(b);
    if (!of_b) return failed("campaign: " + of_b.error().message);
    constexpr double chance_sigmas = 3.0;
    fmt::print("A: {}, {} cases, {} touched down\nB: {}, {} cases, {} touched down\n\n", a.string(),
               of_a->numbers.size(), std::ranges::count(of_a->outcomes, "touchdown"), b.string(), of_b->numbers.size(),
               std::ranges::count(of_b->outcomes, "touchdown"));
    fmt::print("{:<44}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}{:>14}\n", "quantity", "A 1 %", "50 %", "99 %", "B 1 %",
               "50 %", "99 %", "B less A, SE");
    std::size_t differ = 0, quantities = 0;
    for (const auto& one : campaign::compared(*of_a, *of_b)) {
        ++quantities;
        const bool differs = std::abs(one.difference_sigmas) > chance_sigmas;
        if (differs) ++differ;
        if (!all && one.name.find('.') != std::string::npos && !differs) continue;
        fmt::print("{:<44}{:>12.5g}{:>12.5g}{:>12.5g}{:>12.5g}{:>12.5g}{:>12.5g}{:>+14.1f}{}\n", one.name, one.p1_a,
                   one.p50_a, one.p99_a, one.p1_b, one.p50_b, one.p99_b, one.difference_sigmas, differs ? " *" : "");
    }
    fmt::print("\n{} of {} quantities differ in their mean by more than three standard errors (*).\n", differ,
               quantities);
    return 0;
}

int footprints(const std::filesystem::path& file) {
    const auto table = table_of(file);
    if (!table) return failed("campaign: " + table.error().message);
    fmt::print("{:<28}{:>8}{:>22}{:>12}{:>12}{:>12}\n", "99 % ellipse at", "cases", "full axes km", "azimuth deg",
               "east km", "north km");
    for (const auto& [name, east, north] :
         {std::tuple{"parachute", "event.parachute_deploy.east_m", "event.parachute_deploy.north_m"},
          std::tuple{"backshell separation", "event.backshell_separation.east_m", "event.backshell_separation.north_m"},
          std::tuple{"touchdown", "east_m", "north_m"}}) {
        const auto* e = table->column(east);
        const auto* n = table->column(north);
        campaign::PlaneMoments plane;
        for (std::size_t i = 0; e != nullptr && n != nullptr && i < e->values.size(); ++i)
            if (!std::isnan(e->values[i]) && !std::isnan(n->values[i])) plane.add(e->values[i], n->values[i]);
        if (plane.count() < 2) {
            fmt::print("{:<28}{:>8}{:>22}\n", name, plane.count(), "too few cases");
            continue;
        }
        const auto ellipse = plane.ellipse_99();
        fmt::print("{:<28}{:>8}{:>22}{:>12.1f}{:>12.2f}{:>12.2f}\n", name, plane.count(),
                   fmt::format("{:.2f} x {:.2f}", ellipse.major_m * campaign::km, ellipse.minor_m * campaign::km),
                   ellipse.azimuth_deg, ellipse.east_m * campaign::km, ellipse.north_m * campaign::km);
    }
    fmt::print("Centres are from the target.\n");
    return 0;
}

struct SensitivityOptions {
    SharedOptions shared;
    std::string scenario;
    StudyOptions study;
    bool one_at_a_time = false;
    std::filesystem::path out;
};

int sensitivity(const SensitivityOptions& options) {
    const auto said = [](const Error& error) { return failed("campaign sensitivity: " + error.message); };
    if (!options.out.empty())
        if (const auto possible = can_be_made(options.out); !possible) return said(possible.error());
    const auto ready = study_inputs(options.shared, options.scenario);
    if (!ready) return failed(ready.error().message);
    const auto& [dictionary, scenario] = *ready;
    stop_at_interrupt();
    const double course_deg = simulation::course_at_target_deg(scenario);
    std::vector<campaign::Influence> influences;
    campaign::Influence together;
    {
        ProgressLine line;
        const auto groups = options.one_at_a_time ? campaign::single_errors(scenario) : campaign::error_groups();
        influences.reserve(groups.size());
        for (const campaign::ErrorGroup& group : groups) {
            const auto table = cases_flown(options.study, campaign::with_errors(scenario, group), dictionary, line);
            if (!table) return said(table.error());
            influences.push_back(campaign::influence_of(group.name, *table, course_deg));
        }
        auto all = scenario;
        all.name += "-all";  // a file of its own: that of the campaign may have more cases
        const auto table = cases_flown(options.study, all, dictionary, line);
        if (!table) return said(table.error());
        together = campaign::influence_of("all", *table, course_deg);
    }
    fmt::print("{} (seed {}): each {} alone, {} cases; along the course {:.1f} deg at the target\n\n", scenario.name,
               options.study.seed, options.one_at_a_time ? "error" : "group of errors", options.study.cases,
               course_deg);
    fmt::print("{}", campaign::sensitivity_table(influences, together));
    if (options.out.empty()) return 0;
    if (const auto made = make_file(options.out, campaign::sensitivity_csv(influences, together)); !made)
        return said(made.error());
    fmt::print("\nThe table is in {}\n", options.out.string());
    return 0;
}

}  // namespace

void add_campaign_analysis(CLI::App& campaign_app, int& exit_code) {
    const auto file_of = [](CLI::App& command, std::filesystem::path& file) {
        command.add_option("FILE", file, "results of a campaign")->required();
    };
    {
        const auto options = std::make_shared<SensitivityOptions>();
        auto& command = *campaign_app.add_subcommand(
            "sensitivity",
            "flies the campaign with one group of errors at a time, and prints what each makes of the spread: "
            "tornado and budget of the landing ellipse");
        command.add_option("--scenario", options->scenario, "a file, or the name of a shipped one")->required();
        add_study(command, options->study);
        command.add_flag("--one-at-a-time", options->one_at_a_time, "each error of the scenario alone, not by groups");
        command.add_option("--csv", options->out, "write the table to this new file");
        add_shared(command, options->shared);
        command.callback([options, &exit_code] { exit_code = sensitivity(*options); });
    }
    {
        struct Two {
            std::filesystem::path a, b;
            bool all = false;
        };
        const auto options = std::make_shared<Two>();
        auto& command = *campaign_app.add_subcommand("compare", "compares two campaigns, quantity by quantity");
        command.add_option("A", options->a, "results of a campaign")->required();
        command.add_option("B", options->b, "results of another")->required();
        command.add_flag("--all", options->all, "show all events and margins, not only those that differ");
        command.callback([options, &exit_code] { exit_code = compare(options->a, options->b, options->all); });
    }
    {
        struct Given {
            std::filesystem::path file;
            std::vector<std::string> figures{"miss_m",
                                             "east_m",
                                             "north_m",
                                             "propellant_kg",
                                             "vertical_mps",
                                             "horizontal_mps",
                                             "parachute_mach",
                                             "parachute_pressure_Pa",
                                             "peak_deceleration_mps2"};
            std::size_t most = 5;
        };
        const auto options = std::make_shared<Given>();
        auto& command = *campaign_app.add_subcommand(
            "correlate", "prints how figures of the cases go with the errors that were drawn");
        file_of(command, options->file);
        command.add_option("--figure", options->figures, "quantities, as the export names them");
        command.add_option("--most", options->most, "errors shown of each figure, the strongest first")
            ->check(whole_number())
            ->capture_default_str();
        command.callback(
            [options, &exit_code] { exit_code = correlate(options->file, options->figures, options->most); });
    }
    {
        const auto file = std::make_shared<std::filesystem::path>();
        auto& command = *campaign_app.add_subcommand(
            "footprints", "prints the 99 % ellipses at parachute deployment, backshell separation and touchdown");
        file_of(command, *file);
        command.callback([file, &exit_code] { exit_code = footprints(*file); });
    }
    {
        struct Export {
            std::filesystem::path file, csv, hdf5;
        };
        const auto options = std::make_shared<Export>();
        auto& command = *campaign_app.add_subcommand(
            "export",
            "writes a row a case: figures, errors drawn, each event's time, height, speed and place, margins");
        file_of(command, options->file);
        auto& forms = *command.add_option_group("file", "one of them, or both");
        forms.add_option("--csv", options->csv, "the new file, as CSV");
        forms.add_option("--hdf5", options->hdf5, "the new file, as HDF5: a dataset a quantity");
        forms.require_option(1, 2);
        command.callback(
            [options, &exit_code] { exit_code = export_cases(options->file, options->csv, options->hdf5); });
    }
}

}  // namespace aeolis::server
