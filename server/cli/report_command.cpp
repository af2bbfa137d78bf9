// SPDX-License-Identifier: Apache-2.0
#include "server/api/rehearsal_score.hpp"
#include "server/api/run_questions.hpp"
#include "server/api/time_texts.hpp"
#include "server/archive/reader.hpp"
#include "server/base/json.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/options.hpp"
#include "server/cli/recorded_dictionary.hpp"
#include "server/cli/shipped_paths.hpp"
#include "server/instruction/plan_library.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <memory>
#include <vector>

namespace aeolis::server {
namespace {

struct ReportOptions {
    ArchiveOptions of;
    bool json = false, csv = false, explanations = false;
};

std::string from_entry(double e_s) {
    return fmt::format("E{:+.1f}", e_s);
}
/// From entry, or SCLK where nobody knows when that was.
std::string time_text(const v1::RunState& run, double sclk) {
    return run.entry_sclk() == 0.0 ? fmt::format("SCLK {:.1f}", sclk) : from_entry(sclk - run.entry_sclk());
}
std::string from_entry(bool known, double e_s) {
    return known ? from_entry(e_s) : "-";
}

void print_timepoints(const v1::AsFlownReport& report) {
    fmt::print("\n{:<28}{:>10}{:>10}{:>10}{:>10}{:>10}{:>9}  {}\n", "timepoint", "planned", "predicted", "by tone",
               "live", "recorded", "margin", "verdict");
    for (const auto& row : report.timepoints())
        fmt::print("{:<28}{:>10}{:>10}{:>10}{:>10}{:>10}{:>9}  {}\n", row.name(),
                   from_entry(row.has_planned_e_s(), row.planned_e_s()),
                   from_entry(row.has_predicted_e_s(), row.predicted_e_s()),
                   from_entry(row.has_tone_e_s(), row.tone_e_s()),
                   from_entry(row.has_realtime_e_s(), row.realtime_e_s()),
                   from_entry(row.has_recorded_e_s(), row.recorded_e_s()),
                   row.has_margin_s() ? fmt::format("{:.1f} s", row.margin_s()) : "-", row.verdict());
    fmt::print("Predicted: at entry interface, by the timeline's rule over the anchors that ground had then.\n");
    fmt::print("Margin: later than the previous timepoint and the minimum offset from it.\n");
}

void print_events(const v1::AsFlownReport& report) {
    fmt::print("\n{:<30}{:>10}{:>10}{:>10}  {}\n", "event", "predicted", "live", "recorded", "as flight reported it");
    for (const auto& row : report.events())
        fmt::print("{:<30}{:>10}{:>10}{:>10}  {}\n", row.name(),
                   from_entry(row.has_predicted_e_s(), row.predicted_e_s()),
                   from_entry(row.has_realtime_e_s(), row.realtime_e_s()),
                   from_entry(row.has_recorded_e_s(), row.recorded_e_s()), row.text());
}

void print_links(const v1::AsFlownReport& report) {
    fmt::print("\nTones: {} decoded, {} erased.\n", report.tones_decoded(), report.tones_erased());
    for (const auto& counted : report.proof().counters())
        fmt::print("{}: {} good frames, {} bad, {} missing in {} gaps.\n", counted.link(), counted.frames(),
                   counted.bad_crc() + counted.bad_header(), counted.missing_frames(), counted.gaps());
    const auto when = [&](double e_s) { return time_text(report.run(), report.run().entry_sclk() + e_s); };
    for (const auto& silence : report.silences())
        fmt::print("{} silent from {} to {}: {}\n", silence.link(), when(silence.from_e_s()),
                   silence.has_to_e_s() ? when(silence.to_e_s()) : "the end", silence.reason());
}

void print_proof(const v1::ProofReport& proof) {
    v1::ProofRow all;
    for (const auto& row : proof.streams()) {
        all.set_realtime(all.realtime() + row.realtime());
        all.set_identical(all.identical() + row.identical());
        all.set_differs(all.differs() + row.differs());
        all.set_missing_in_recording(all.missing_in_recording() + row.missing_in_recording());
        all.set_never_seen_live(all.never_seen_live() + row.never_seen_live());
        all.set_pending(all.pending() + row.pending());
    }
    fmt::print("\nOf {} packets seen live {} are in the recording bit for bit, {} differ, {} are missing in it, {} "
               "wait for it; "
               "{} were never seen live.{}\n",
               all.realtime(), all.identical(), all.differs(), all.missing_in_recording(), all.pending(),
               all.never_seen_live(), proof.recording_complete() ? "" : " The recording is not complete.");
}

/// A note on one line: control characters are replaced by spaces.
std::string one_line(std::string text) {
    std::ranges::replace_if(text, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }, ' ');
    return text;
}

void print_notes(const v1::AsFlownReport& report) {
    for (const auto& item : report.notes()) {
        const auto& note = item.note();
        const auto when = note.has_sclk() ? time_text(report.run(), note.sclk()) : note.at();
        fmt::print("Note {} by {}: {}\n", when, one_line(note.by()), one_line(note.text()));
    }
}

/// Prints each decision on board with its conditions, in the order of the spacecraft's clock.
int print_explanations(archive::Reader& reader, archive::RunId run) {
    const auto state = reader.run(run);
    if (!state) return failed(state.error().message);
    std::vector<v1::Explanation> decisions;
    archive::ExplanationQuery query;
    do {
        const auto page = reader.explanations(run, query);
        if (!page) return failed(page.error().message);
        for (const auto& item : page->explanations()) decisions.push_back(item.explanation());
        query.after = page->next_after();
    } while (query.after != 0);
    std::ranges::stable_sort(decisions, {}, [](const v1::Explanation& decision) { return decision.sclk(); });
    for (const v1::Explanation& decision : decisions)
        fmt::print("{:>9}  {}\n", time_text(*state, decision.sclk()), decision.text());
    return 0;
}

Result<void> print_score(archive::Reader& reader, const v1::AsFlownReport& report,
                         const dictionary::Dictionary& dictionary, const std::filesystem::path& folder) {
    const auto rubric = instruction::PlanLibrary{folder, dictionary}.rubric();
    if (!rubric) return Error{"no score without a rubric: " + rubric.error().message};
    const auto score = rehearsal_score(reader, report, dictionary, *rubric);
    if (!score) return score.error();
    fmt::print("\nScore {:.0f} of 100\n", score->sum());
    for (const auto& term : score->terms()) {
        fmt::print("  {:<13} {:>4.1f} of {:>4.1f}  {}\n", term.name(), term.points(), term.worth(), term.why());
        for (const auto& point : term.judged())
            fmt::print("    {:>3.0f} %  {:>9}  {}: {}\n", 100.0 * point.share(), from_entry(point.e_s()),
                       point.expected(), point.evidence());
    }
    return {};
}

/// Prints the as-flown report of a run.
int report(const ReportOptions& options) {
    int exit_code = 0;
    const auto recorded = recorded_dictionary(options.of.shared.dictionary, {}, exit_code);
    if (!recorded) return exit_code;
    auto reader = archive::Reader::open(options.of.archive, recorded->dictionary);
    if (!reader) return failed(reader.error().message);
    const archive::RunId number{options.of.run.value_or(0)};
    if (options.explanations) return print_explanations(*reader, number);
    auto report = whole_report(*reader, number);
    if (!report) return failed(fmt::format("{}: {}", options.of.archive.string(), report.error().message));
    write_time_texts(*report);
    if (options.json) {
        fmt::print("{}\n", to_json(*report));
        return 0;
    }
    if (options.csv) {
        fmt::print("{}", as_flown_csv(*report));
        return 0;
    }
    const auto& run = report->run();
    fmt::print("Run {}: {}, seed {}, {}; {}\n", run.run(), run.scenario(), run.seed(),
               v1::Landing::Outcome_Name(run.outcome()), run.started());
    print_timepoints(*report);
    print_events(*report);
    print_links(*report);
    print_proof(report->proof());
    for (const auto& command : report->commands())
        if (command.stages_size() > 0) {
            const auto& last = command.stages(command.stages_size() - 1).command_stage();
            fmt::print("Command {} {}: {} {}, {}\n", command.command(), command.name(),
                       v1::CommandStage::Stage_Name(last.stage()), v1::CommandStage::Status_Name(last.status()),
                       last.evidence());
        }
    print_notes(*report);
    if (!has_score(run)) return 0;
    const auto scored = print_score(*reader, *report, recorded->dictionary, options.of.shared.dictionary);
    return scored ? 0 : failed(scored.error().message);
}

}  // namespace

void add_report_command(CLI::App& program, int& exit_code) {
    const auto options = std::make_shared<ReportOptions>();
    auto& command = *program.add_subcommand(
        "report", "prints a run as it was flown: each timepoint and event by plan, tone, live telemetry and "
                  "recording, the silences, the proof, and the score of a rehearsal");
    add_archive_file(command, options->of.archive);
    command.add_option("--dictionary", options->of.shared.dictionary, "directory of the mission's dictionary")
        ->capture_default_str();
    command.add_option("--run", options->of.run, "number of the run")->required()->check(whole_number());
    auto* json = command.add_flag("--json", options->json, "print one JSON object");
    auto* csv = command.add_flag("--csv", options->csv, "print timepoints and events, a row each")->excludes(json);
    command
        .add_flag("--explanations", options->explanations,
                  "print only the decisions on board, each with its conditions")
        ->excludes(json)
        ->excludes(csv);
    command.callback([options, &exit_code] { exit_code = report(*options); });
}

}  // namespace aeolis::server
