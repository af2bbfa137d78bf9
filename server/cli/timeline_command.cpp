// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/analysis/timeline_analysis.hpp"
#include "dictionaries/analysis/timeline_diff.hpp"
#include "dictionaries/words.hpp"
#include "server/base/json_object.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/options.hpp"
#include "server/cli/shipped_paths.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <set>
#include <tuple>
#include <utility>

namespace aeolis::server {
namespace {

struct TimelineAnalyseOptions {
    std::filesystem::path directory = SharedOptions{}.dictionary;
    bool json = false;
};

struct TimelineDiffOptions {
    std::filesystem::path before, after;
    bool json = false;
};

using namespace dictionary;

std::string seconds(double value_s) {
    return number_word(value_s) + " s";
}

std::string_view reason_text(ChainStep::Reason reason) {
    switch (reason) {
    case ChainStep::Reason::order: return "order of the timeline";
    case ChainStep::Reason::minimum: return "minimum offset";
    case ChainStep::Reason::desired: return "desired offset";
    case ChainStep::Reason::cycle_limit: return "five a cycle";
    case ChainStep::Reason::reply: return "fires after it is triggered";
    case ChainStep::Reason::reply_timeout: return "reply or time-out";
    case ChainStep::Reason::anchor_offset: return "offset of the anchor";
    case ChainStep::Reason::given: return "given";
    case ChainStep::Reason::as_soon_as: return "triggered as soon as it may be";
    }
    return "";
}

std::string_view proof_text(Proof proof) {
    return proof == Proof::proven ? "proven" : proof == Proof::refuted ? "refuted" : "undecided";
}

std::string place_text(const ChainStep& step) {
    const bool is_given = step.reason == ChainStep::Reason::given;
    if (step.line == 0) return "anchors.csv";
    return fmt::format("{}:{}", is_given ? "constraints.csv" : "timeline.csv", step.line);
}

std::string slack_text(const MaybeOffset& slack_s) {
    return slack_s ? fmt::format("{:.6f}", *slack_s) : "unbounded";
}

/// A bound as text: radar_power:fired -> heatshield_separation:triggered >= 8 s
std::string bound_text(const Dictionary& d, const BoundProof& bound) {
    const ConstraintRow& row = d.constraints[bound.constraint];
    return fmt::format("{} -> {} {} {}", moment_text(d, row.from), moment_text(d, row.to),
                       bound.is_minimum ? ">=" : "<=", seconds(bound.is_minimum ? *row.minimum_s : *row.maximum_s));
}

void print_chain(const Dictionary& d, const std::vector<ChainStep>& chain) {
    for (const ChainStep& step : chain)
        fmt::print("      {} >= {} {} {}  ({}, {})\n", moment_text(d, step.to), moment_text(d, step.from),
                   step.at_least_s < 0.0 ? '-' : '+', seconds(std::abs(step.at_least_s)), reason_text(step.reason),
                   place_text(step));
}

/// Prints the schedule's moments from one end of a claim to the other, and their anchors.
void print_counter_example(const Dictionary& d, const Moment& from, const Moment& to,
                           const std::vector<Instant>& schedule) {
    const auto time_of = [&](const Moment& moment) {
        return std::ranges::find(schedule, moment, &Instant::moment)->time_s;
    };
    const double from_s = time_of(from);
    const double to_s = time_of(to);
    fmt::print("    a counter-example, in seconds from {}: {} comes at {}\n", moment_text(d, from), moment_text(d, to),
               number_word(to_s - from_s));
    std::set<std::uint16_t> anchors;
    std::vector<Instant> shown;
    shown.reserve(schedule.size());
    for (const Instant& instant : schedule) {
        if (instant.moment.kind == Moment::Kind::anchor || instant.moment.kind == Moment::Kind::do_edl) continue;
        if (instant.time_s < std::min(from_s, to_s) || instant.time_s > std::max(from_s, to_s)) continue;
        shown.push_back(instant);
        const auto& anchor = d.timeline[instant.moment.index].anchor;
        if (anchor) anchors.insert(anchor->value);
    }
    for (const Instant& instant : schedule) {
        const bool is_end = instant.moment == from || instant.moment == to;
        if (instant.moment.kind == Moment::Kind::do_edl
                ? is_end
                : instant.moment.kind == Moment::Kind::anchor && (is_end || anchors.contains(instant.moment.index)))
            shown.push_back(instant);
    }
    std::ranges::sort(shown, {}, [](const Instant& instant) {
        const bool is_timepoint = instant.moment.kind >= Moment::Kind::triggered;
        return std::tuple{instant.time_s, is_timepoint, instant.moment.index, instant.moment.kind};
    });
    for (const Instant& instant : shown)
        fmt::print("      {:>14.6f}  {}\n", instant.time_s - from_s, moment_text(d, instant.moment));
}

void print_bound(const Dictionary& d, const BoundProof& bound) {
    fmt::print("  constraints.csv:{}: {}: {}\n", d.constraints[bound.constraint].line, bound_text(d, bound),
               bound.proof == Proof::undecided ? "undecided: the search was cut short" : proof_text(bound.proof));
    if (bound.proof == Proof::refuted) {
        const ConstraintRow& row = d.constraints[bound.constraint];
        print_counter_example(d, row.from, row.to, bound.schedule);
    }
    fmt::print("{}", bound.chain.empty() ? "    nothing bounds it\n" : "    critical chain\n");
    print_chain(d, bound.chain);
}

void print_holds(const Dictionary& d, const std::vector<HoldProof>& holds) {
    fmt::print("\nWhat GNC triggers waits for no row that GNC does not need, however early it comes\n");
    std::size_t proven = 0;
    for (const HoldProof& hold : holds) {
        proven += hold.proof == Proof::proven;
        if (hold.proof == Proof::proven) continue;
        const TimelineRow& triggered = d.timeline[hold.triggered.value];
        const TimelineRow& before = d.timeline[hold.before.value];
        fmt::print("  timeline.csv:{}: {} may wait for {} (timeline.csv:{}): {}\n", triggered.line, triggered.name,
                   before.name, before.line, proof_text(hold.proof));
        if (hold.proof == Proof::refuted)
            print_counter_example(d, Moment::of_anchor(*triggered.anchor), Moment::of_fired(before.id), hold.schedule);
    }
    fmt::print("  {} of {} pairs proven.\n", proven, holds.size());
}

void print_analysis(const Dictionary& d, const TimelineAnalysis& analysis) {
    const auto given =
        std::ranges::count_if(d.constraints, [](const auto& row) { return row.kind != ConstraintRow::Kind::required; });
    fmt::print("{}, timeline version {}: {} timepoints, {} anchors, {} given rows, {} bounds to prove\n", d.mission,
               d.timeline_version, d.timeline.size(), d.anchors.size(), given, analysis.bounds.size());
    if (!analysis.contradiction.empty()) {
        fmt::print("\nThe timeline and the given rows contradict one another: these cannot all hold\n");
        print_chain(d, analysis.contradiction);
        return;
    }
    if (!analysis.admits_schedule) {
        fmt::print(
            "\nThe timeline, fired as soon as it may be, contradicts the given rows: no schedule keeps all of them\n");
        return;
    }
    fmt::print("\nConstraints (slack: what the worst schedule leaves)\n  {:>14}  {:<9}  constraint\n", "slack [s]",
               "verdict");
    for (const BoundProof& bound : analysis.bounds)
        fmt::print("  {:>14}  {:<9}  {}  (constraints.csv:{})\n", slack_text(bound.slack_s), proof_text(bound.proof),
                   bound_text(d, bound), d.constraints[bound.constraint].line);
    fmt::print(
        "\nTimepoints with an anchor (margin: free to fire so long before the anchor makes them due; negative: may "
        "be so late)\n  {:>14}  timepoint\n",
        "margin [s]");
    for (const DueMargin& margin : analysis.margins)
        fmt::print("  {:>14}  {}\n", slack_text(margin.slack_s), d.timeline[margin.timepoint.value].name);

    print_holds(d, analysis.holds);
    const auto not_proven = [](const BoundProof& bound) { return bound.proof != Proof::proven; };
    const auto failures = std::ranges::count_if(analysis.bounds, not_proven);
    if (failures == 0) {
        // Of equal slacks the longest chain: it has the most that can shift.
        const auto least = std::ranges::min_element(analysis.bounds, {}, [](const BoundProof& bound) {
            return std::pair{bound.slack_s.value_or(0.0), -static_cast<std::ptrdiff_t>(bound.chain.size())};
        });
        if (least != analysis.bounds.end()) {
            fmt::print("\nLeast slack, {} s\n", slack_text(least->slack_s));
            print_bound(d, *least);
        }
        fmt::print("\nAll {} bounds are proven.\n", analysis.bounds.size());
        return;
    }
    fmt::print("\nNot proven: {} of {}\n", failures, analysis.bounds.size());
    for (const BoundProof& bound : analysis.bounds)
        if (not_proven(bound)) print_bound(d, bound);
}

std::string maybe_number(const MaybeOffset& value) {
    return value ? json_number(*value) : "null";
}

std::string chain_json(const Dictionary& d, const std::vector<ChainStep>& chain) {
    return json_array(chain, [&](const ChainStep& step) {
        return JsonObject{}
            .text("from", moment_text(d, step.from))
            .text("to", moment_text(d, step.to))
            .number("at_least_s", step.at_least_s)
            .text("reason", reason_text(step.reason))
            .text("place", place_text(step))
            .str();
    });
}

std::string schedule_json(const Dictionary& d, const std::vector<Instant>& schedule) {
    return json_array(schedule, [&](const Instant& instant) {
        return JsonObject{}
            .text("moment", moment_text(d, instant.moment))
            .number("since_do_edl_s", instant.time_s)
            .str();
    });
}

std::string analysis_json(const Dictionary& d, const TimelineAnalysis& analysis) {
    const auto bound_json = [&](const BoundProof& bound) {
        const ConstraintRow& row = d.constraints[bound.constraint];
        JsonObject object;
        object.count("line", row.line)
            .text("from", moment_text(d, row.from))
            .text("to", moment_text(d, row.to))
            .text("bound", bound.is_minimum ? "minimum" : "maximum")
            .number("bound_s", bound.is_minimum ? *row.minimum_s : *row.maximum_s)
            .text("proof", proof_text(bound.proof))
            .raw("slack_s", maybe_number(bound.slack_s))
            .raw("critical_chain", chain_json(d, bound.chain));
        if (bound.proof == Proof::refuted) object.raw("counter_example", schedule_json(d, bound.schedule));
        return object.str();
    };
    const auto hold_json = [&](const HoldProof& hold) {
        JsonObject object;
        object.text("triggered", d.timeline[hold.triggered.value].name)
            .text("before", d.timeline[hold.before.value].name)
            .text("proof", proof_text(hold.proof));
        if (hold.proof == Proof::refuted) object.raw("counter_example", schedule_json(d, hold.schedule));
        return object.str();
    };
    const auto margin_json = [&](const DueMargin& margin) {
        return JsonObject{}
            .text("timepoint", d.timeline[margin.timepoint.value].name)
            .raw("margin_s", maybe_number(margin.slack_s))
            .str();
    };
    return JsonObject{}
        .text("mission", d.mission)
        .count("timeline_version", d.timeline_version)
        .raw("all_proven", analysis.all_proven() ? "true" : "false")
        .raw("admits_schedule", analysis.contradiction.empty() && analysis.admits_schedule ? "true" : "false")
        .raw("contradiction", chain_json(d, analysis.contradiction))
        .raw("bounds", json_array(analysis.bounds, bound_json))
        .raw("margins", json_array(analysis.margins, margin_json))
        .raw("holds", json_array(analysis.holds, hold_json))
        .str();
}

void print_diff(const TimelineDiff& diff) {
    fmt::print("timeline version {} -> {}\n", diff.version_before, diff.version_after);
    std::size_t rows = 0;
    for (const SheetDiff& sheet : diff.sheets) {
        rows += sheet.rows.size();
        if (!sheet.rows.empty()) fmt::print("{}\n", sheet.file);
        for (const RowChange& row : sheet.rows) {
            if (!row.after)
                fmt::print("  - {}  (was row {})\n", row.name, *row.before);
            else if (!row.before)
                fmt::print("  + {}  (row {})\n", row.name, *row.after);
            else if (row.moved)
                fmt::print("  ~ {}  (moved from row {} to row {})\n", row.name, *row.before, *row.after);
            else
                fmt::print("  ~ {}\n", row.name);
            for (const CellChange& cell : row.cells)
                fmt::print("      {}: {} -> {}\n", cell.column, cell.before.empty() ? "(empty)" : cell.before,
                           cell.after.empty() ? "(empty)" : cell.after);
        }
    }
    if (rows == 0)
        fmt::print("{}", diff.version_before == diff.version_after
                             ? "No row differs.\n"
                             : "No row differs; the versions differ in how the sheets are written only.\n");
    else
        fmt::print("{} {}.\n", rows, rows == 1 ? "row differs" : "rows differ");
}

std::string diff_json(const TimelineDiff& diff) {
    const auto cell_json = [](const CellChange& cell) {
        return JsonObject{}.text("column", cell.column).text("before", cell.before).text("after", cell.after).str();
    };
    const auto row_json = [&](const RowChange& row) {
        const auto place = [](const std::optional<std::size_t>& at) { return at ? std::to_string(*at) : "null"; };
        return JsonObject{}
            .text("name", row.name)
            .text("change", !row.after    ? "removed"
                            : !row.before ? "added"
                            : row.moved   ? "moved"
                                          : "changed")
            .raw("row_before", place(row.before))
            .raw("row_after", place(row.after))
            .raw("cells", json_array(row.cells, cell_json))
            .str();
    };
    const auto sheet_json = [&](const SheetDiff& sheet) {
        return JsonObject{}.text("file", sheet.file).raw("rows", json_array(sheet.rows, row_json)).str();
    };
    return JsonObject{}
        .count("version_before", diff.version_before)
        .count("version_after", diff.version_after)
        .raw("same", diff.same() ? "true" : "false")
        .raw("sheets", json_array(diff.sheets, sheet_json))
        .str();
}

bool is_folder(const std::filesystem::path& path) {
    std::error_code error;
    return std::filesystem::is_directory(path, error);
}

/// Returns 0 when every required row of constraints.csv and every hold is proven.
int timeline_analyse(const TimelineAnalyseOptions& options) {
    if (!is_folder(options.directory))
        return failed(fmt::format("timeline analyse: {} is not a directory", options.directory.string()), 2);
    const auto dictionary = loaded_dictionary(options.directory);
    if (!dictionary) return 1;
    const auto analysis = analyse_timeline(*dictionary);
    if (options.json)
        fmt::print("{}\n", analysis_json(*dictionary, analysis));
    else
        print_analysis(*dictionary, analysis);
    return analysis.all_proven() ? 0 : 1;
}

/// Returns 0 when no row differs.
int timeline_diff(const TimelineDiffOptions& options) {
    for (const auto& directory : {options.before, options.after})
        if (!is_folder(directory))
            return failed(fmt::format("timeline diff: {} is not a directory", directory.string()), 2);
    const auto before = loaded_dictionary(options.before);
    const auto after = loaded_dictionary(options.after);
    if (!before || !after)
        return failed((before ? options.after : options.before).string() + " breaks the rules above");
    const auto diff = compare_timelines(*before, *after);
    if (options.json)
        fmt::print("{}\n", diff_json(diff));
    else
        print_diff(diff);
    return diff.same() ? 0 : 1;
}

void add_timeline_analyse(CLI::App& timeline, int& exit_code) {
    const auto options = std::make_shared<TimelineAnalyseOptions>();
    auto& command = *timeline.add_subcommand("analyse", "proves or refutes each row of constraints.csv, and that GNC "
                                                        "waits for nothing that it does not need; exit code 1 "
                                                        "when one is not proven");
    command.add_option("DIR", options->directory, "the dictionary's directory")->capture_default_str();
    command.add_flag("--json", options->json, "print one JSON object");
    command.callback([options, &exit_code] { exit_code = timeline_analyse(*options); });
}

void add_timeline_diff(CLI::App& timeline, int& exit_code) {
    const auto options = std::make_shared<TimelineDiffOptions>();
    auto& command = *timeline.add_subcommand(
        "diff",
        "prints rows added, removed, moved or changed between two dictionaries; exit code 1 when there are any");
    command.add_option("DIR_A", options->before, "the earlier dictionary's directory")->required();
    command.add_option("DIR_B", options->after, "the later one's")->required();
    command.add_flag("--json", options->json, "print one JSON object");
    command.callback([options, &exit_code] { exit_code = timeline_diff(*options); });
}

}  // namespace

void add_timeline_command(CLI::App& program, int& exit_code) {
    auto& timeline =
        *program.add_subcommand("timeline", "proves the timeline's constraints, and compares two versions");
    timeline.require_subcommand(1);
    add_timeline_analyse(timeline, exit_code);
    add_timeline_diff(timeline, exit_code);
}

}  // namespace aeolis::server
