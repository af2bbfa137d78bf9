// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/campaign_report.hpp"

#include "server/base/json_object.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace aeolis::server::campaign {
namespace {

std::string spread_json(const Spread& spread) {
    JsonObject object;
    object.count("count", spread.count);
    if (spread.count == 0) return object.str();
    return object.number("min", spread.least)
        .number("p1", spread.p1)
        .number("p50", spread.p50)
        .number("p99", spread.p99)
        .number("max", spread.most)
        .number("mean", spread.mean)
        .number("sigma", spread.sigma)
        .str();
}

std::string again(const Summary& summary, const Call& call, std::uint64_t number) {
    return fmt::format("aeolis rehearse --scenario {} --seed {} --case {}", call.scenario, summary.seed, number);
}

std::string percent(std::uint64_t part, std::uint64_t of) {
    return fmt::format("{:.2f} %", of == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(of));
}

constexpr const char* columns = "{:<34}{:>10}{:>10}{:>10}{:>10}{:>10}{:>7}\n";

std::string heading(const char* what) {
    return fmt::format(columns, what, "1 %", "50 %", "99 %", "mean", "sigma", "cases");
}

std::string row(const std::string& what, const Spread& spread, int digits, double scale = 1.0) {
    if (spread.count == 0) return fmt::format("{:<34}{:>10}\n", what, "none");
    const auto number = [&](double value) { return fmt::format("{:.{}f}", value * scale, digits); };
    return fmt::format(columns, what, number(spread.p1), number(spread.p50), number(spread.p99), number(spread.mean),
                       number(spread.sigma), spread.count);
}

std::string event_rows(const Summary& summary) {
    std::string text = heading("event");
    for (const EventSpread& event : summary.events)
        text += row(event.name + "  E+s", event.e_s, 2) + row("    altitude km", event.altitude_m, 3, km) +
                row("    speed m/s", event.speed_mps, 2);
    return text;
}

std::string margin_rows(const Summary& summary) {
    std::string text = heading("timeline margin s");
    for (const MarginSpread& margin : summary.margins) text += row(margin.timepoint, margin.margin_s, 3);
    return text;
}

std::string failure_rows(const Summary& summary, const Call& call, const std::vector<Failure>& failures,
                         std::uint64_t count) {
    std::string text;
    for (const Failure& failure : failures)
        text += fmt::format("case {}: {} at cycle {}: {}\n    {}\n", failure.number, failure.outcome, failure.end_cycle,
                            failure.reason, again(summary, call, failure.number));
    if (count > failures.size()) text += fmt::format("and {} more in the results\n", count - failures.size());
    return text;
}

}  // namespace

std::string ellipse_json(const Ellipse& ellipse) {
    return JsonObject{}
        .number("major_km", ellipse.major_m * km)
        .number("minor_km", ellipse.minor_m * km)
        .number("azimuth_deg", ellipse.azimuth_deg)
        .number("centre_east_km", ellipse.east_m * km)
        .number("centre_north_km", ellipse.north_m * km)
        .str();
}

std::string campaign_json(const Summary& summary, const CampaignVerdict& verdict, const Call& call) {
    JsonObject outcomes;
    for (const auto& [outcome, count] : summary.outcomes) outcomes.count(outcome, count);
    const auto event_json = [](const EventSpread& event) {
        return JsonObject{}
            .text("name", event.name)
            .raw("e_s", spread_json(event.e_s))
            .raw("altitude_m", spread_json(event.altitude_m))
            .raw("speed_mps", spread_json(event.speed_mps))
            .str();
    };
    const auto failure_json = [&](const Failure& failure) {
        return JsonObject{}
            .count("case", failure.number)
            .text("outcome", failure.outcome)
            .text("reason", failure.reason)
            .count("end_cycle", failure.end_cycle)
            .text("again", again(summary, call, failure.number))
            .str();
    };
    const auto margin_of = [](const MarginSpread& margin) {
        return JsonObject{}.text("timepoint", margin.timepoint).raw("margin_s", spread_json(margin.margin_s)).str();
    };
    const auto margin_json = !summary.least_margin ? std::string{"null"}
                                                   : JsonObject{}
                                                         .number("margin_s", summary.least_margin->margin_s)
                                                         .text("timepoint", summary.least_margin->timepoint)
                                                         .count("case", summary.least_margin->number)
                                                         .str();
    const auto worker_json = [](const WorkerShare& worker) {
        return JsonObject{}.text("name", worker.name).count("flown", worker.flown).str();
    };
    const auto set_aside_json = [](const SetAside& one) {
        return JsonObject{}.count("case", one.number).text("reason", one.reason).str();
    };
    return JsonObject{}
        .text("scenario", summary.scenario)
        .count("seed", summary.seed)
        .count("cases", summary.cases)
        .count("kept", summary.kept)
        .text("results", call.results)
        .raw("outcomes", outcomes.str())
        .raw("events", json_array(summary.events, event_json))
        .raw("touchdown", JsonObject{}
                              .raw("vertical_mps", spread_json(summary.vertical_mps))
                              .raw("horizontal_mps", spread_json(summary.horizontal_mps))
                              .raw("miss_m", spread_json(summary.miss_m))
                              .raw("latitude_deg", spread_json(summary.latitude_deg))
                              .raw("longitude_deg", spread_json(summary.longitude_deg))
                              .raw("ellipse_99", ellipse_json(summary.ellipse))
                              .str())
        .raw("parachute", JsonObject{}
                              .raw("mach", spread_json(summary.parachute_mach))
                              .raw("dynamic_pressure_Pa", spread_json(summary.parachute_pressure_Pa))
                              .str())
        .raw("peak_deceleration_mps2", spread_json(summary.peak_deceleration_mps2))
        .raw("propellant_kg", spread_json(summary.propellant_kg))
        .raw("timeline_margins", json_array(summary.margins, margin_of))
        .raw("least_margin", margin_json)
        .raw("heatshield_least_m", spread_json(summary.heatshield_least_m))
        .raw("backshell_least_m", spread_json(summary.backshell_least_m))
        .count("recontacts", summary.recontacts)
        .count("failed", summary.failed)
        .raw("failures", json_array(summary.failures, failure_json))
        .count("outside_limits", summary.outside_limits)
        .raw("outside", json_array(summary.outside, failure_json))
        .raw("limits", verdict_json(verdict))
        .count("jobs", call.queue.empty() ? call.jobs : 0)
        .count("flown", call.progress.flown)
        .raw("workers", json_array(call.progress.workers, worker_json))
        .raw("set_aside", json_array(call.progress.set_aside, set_aside_json))
        .count("refused_answers", call.progress.refused_answers)
        .number("wall_s", call.progress.wall_s)
        .number("cases_per_second", call.progress.rate_per_s())
        .str();
}

std::string campaign_table(const Summary& summary, const CampaignVerdict& verdict, const Call& call) {
    std::string text =
        fmt::format("{} (seed {}): {} of {} cases\n\n", summary.scenario, summary.seed, summary.kept, summary.cases);
    for (const auto& [outcome, count] : summary.outcomes)
        text += fmt::format("{:<34}{:>10}{:>10}\n", outcome, count, percent(count, summary.kept));
    text += '\n' + event_rows(summary) + '\n' + heading("touchdown");
    text += row("vertical m/s", summary.vertical_mps, 3) + row("horizontal m/s", summary.horizontal_mps, 3) +
            row("miss km", summary.miss_m, 3, km) + row("latitude deg", summary.latitude_deg, 4) +
            row("longitude deg", summary.longitude_deg, 4);
    text += '\n' + heading("along the way") + row("peak deceleration m/s2", summary.peak_deceleration_mps2, 2) +
            row("parachute Mach", summary.parachute_mach, 3) +
            row("parachute dynamic pressure Pa", summary.parachute_pressure_Pa, 1) +
            row("propellant left kg", summary.propellant_kg, 1) +
            row("heatshield nearest m", summary.heatshield_least_m, 1) +
            row("backshell nearest m", summary.backshell_least_m, 1) + '\n' + margin_rows(summary) + '\n';
    const Ellipse& ellipse = summary.ellipse;
    text += fmt::format("99 % ellipse {:.2f} x {:.2f} km, major axis at azimuth {:.1f} deg, centre {:+.2f} km east, "
                        "{:+.2f} km north of the target\n",
                        ellipse.major_m * km, ellipse.minor_m * km, ellipse.azimuth_deg, ellipse.east_m * km,
                        ellipse.north_m * km);
    if (summary.parachute_mach.count > 0)
        text += fmt::format("parachute box Mach {:.3f} … {:.3f}, {:.1f} … {:.1f} Pa\n", summary.parachute_mach.least,
                            summary.parachute_mach.most, summary.parachute_pressure_Pa.least,
                            summary.parachute_pressure_Pa.most);
    if (summary.propellant_kg.count > 0)
        text += fmt::format("least propellant left {:.1f} kg\n", summary.propellant_kg.least);
    if (const auto& margin = summary.least_margin)
        text += fmt::format("least timeline margin {:.3f} s, of {} in case {}\n", margin->margin_s, margin->timepoint,
                            margin->number);
    if (summary.backshell_least_m.count > 0)
        text += fmt::format("{} recontacts; backshell never nearer than {:.1f} m\n", summary.recontacts,
                            summary.backshell_least_m.least);
    text += summary.failed == 0 ? "no case failed\n" : fmt::format("\n{} failed\n", summary.failed);
    text += failure_rows(summary, call, summary.failures, summary.failed);
    if (summary.outside_limits > 0) text += fmt::format("\n{} landed outside limits\n", summary.outside_limits);
    text += failure_rows(summary, call, summary.outside, summary.outside_limits);
    text += '\n' + verdict_table(verdict);
    if (summary.kept < summary.cases)
        text += fmt::format("that is of the cases flown so far: {} are missing\n", summary.cases - summary.kept);
    text += '\n';
    const auto& progress = call.progress;
    const auto by =
        call.queue.empty() ? fmt::format("{} jobs", call.jobs) : fmt::format("{} workers", progress.workers.size());
    text += fmt::format("{} cases flown now in {:.1f} s, {}, {:.2f} cases/s; results in {}\n", progress.flown,
                        progress.wall_s, by, progress.rate_per_s(), call.results);
    for (const auto& [name, flown] : progress.workers)
        text += fmt::format("    {:<30}{:>10} cases{:>10.2f} cases/s\n", name, flown,
                            progress.wall_s > 0.0 ? static_cast<double>(flown) / progress.wall_s : 0.0);
    for (const auto& [number, reason] : progress.set_aside)
        text += fmt::format("case {} is set aside: {}\n    {}\n", number, reason, again(summary, call, number));
    if (progress.refused_answers > 0)
        text += fmt::format("{} answers in the queue were not of this campaign's cases, and were refused\n",
                            progress.refused_answers);
    return text;
}

std::string progress_line(const Progress& progress) {
    constexpr std::size_t width = 30;
    const double part = progress.of == 0 ? 1.0 : static_cast<double>(progress.done) / static_cast<double>(progress.of);
    const auto filled = std::min(width, static_cast<std::size_t>(part * static_cast<double>(width)));
    std::string bar(filled, '=');
    if (filled < width) bar += '>';
    bar.resize(width, ' ');
    std::string text = fmt::format("[{}] {}/{}", bar, progress.done, progress.of);
    if (!progress.workers.empty()) text += fmt::format("  {} workers", progress.workers.size());
    if (!progress.waiting_for.empty()) return text + "  " + progress.waiting_for;
    const double rate_per_s = progress.rate_per_s();
    if (rate_per_s <= 0.0) return text;
    const auto left_s = std::llround(static_cast<double>(progress.of - progress.done) / rate_per_s);
    return text + fmt::format("  {:.2f} cases/s, {} min {:02} s remain", rate_per_s, left_s / 60, left_s % 60);
}

}  // namespace aeolis::server::campaign
