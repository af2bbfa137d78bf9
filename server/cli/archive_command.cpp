// SPDX-License-Identifier: Apache-2.0
#include "server/access/this_user.hpp"
#include "server/archive/archive_comparison.hpp"
#include "server/archive/upkeep.hpp"
#include "server/base/wall_clock.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/long_work.hpp"
#include "server/cli/options.hpp"
#include "server/cli/recorded_dictionary.hpp"
#include "server/cli/shipped_paths.hpp"
#include "server/pipeline/derivation.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <memory>

namespace aeolis::server {
namespace {

struct PruneOptions {
    std::filesystem::path archive = default_archive;
    std::vector<std::uint32_t> runs;
    std::optional<std::size_t> keep;  ///< keep this many newest runs
    bool yes = false;                 ///< false: only prints what it would do
};

struct BackupOptions {
    std::filesystem::path archive = default_archive, copy;
};

struct CompareOptions {
    std::filesystem::path archive = default_archive, with;
};

int failed_at(const char* command, const Error& error) {
    return failed(fmt::format("archive {}: {}", command, error.message));
}

std::optional<archive::RunId> asked(const ArchiveOptions& options) {
    return options.run ? std::optional(archive::RunId{*options.run}) : std::nullopt;
}

/// Prints the progress; ends at the first Ctrl-C.
pipeline::ProgressCallback until_interrupted(ProgressLine& line) {
    stop_at_interrupt();
    return [&line](const pipeline::Progress& progress) {
        line.draw(fmt::format("run {}: {} of {} packets", progress.run.value, progress.packets, progress.of_packets));
        return !stop_asked();
    };
}

/// The time, user and address for an audit entry.
archive::AuditRecord by_this_user() {
    archive::AuditRecord by;
    by.at = wall_clock_text();
    by.who = this_user();
    by.from = command_line;
    return by;
}

/// The runs to delete; an Error for wrong options.
Result<std::vector<archive::RunLine>> chosen(const PruneOptions& options, const std::vector<archive::RunLine>& all) {
    std::vector<archive::RunLine> runs;
    if (options.keep) {
        const std::size_t kept = std::min(*options.keep, all.size());
        runs.assign(all.begin(), all.end() - static_cast<std::ptrdiff_t>(kept));
        return runs;
    }
    for (const std::uint32_t number : options.runs) {
        const auto found = std::ranges::find(all, archive::RunId{number}, &archive::RunLine::run);
        if (found == all.end()) return Error{fmt::format("no run {} in {}", number, options.archive.string())};
        runs.push_back(*found);
    }
    return runs;
}

struct VerifyOptions : ArchiveOptions {
    std::string head;  ///< of the audit: a file, or ENTRY:HASH; empty: the file beside the archive, if there is one
};

/// The head of the audit that was kept outside the archive; none: none is known.
Result<std::optional<archive::AuditHead>> known_head(const VerifyOptions& options) {
    if (const auto given = archive::head_from_text(options.head)) return std::optional{*given};
    if (options.head.empty())
        return archive::read_head(archive::head_file(options.archive, options.archive.parent_path()));
    auto read = archive::read_head(options.head);
    if (read && !*read) return Error{fmt::format("--audit-head {}: neither a file nor ENTRY:HASH", options.head)};
    return read;
}

/// Returns 0 when there is no fault.
int archive_verify(const VerifyOptions& options) {
    int exit_code = 0;
    const auto known = known_head(options);
    if (!known) return failed_at("verify", known.error());
    const auto recorded = recorded_dictionary(options.shared.dictionary, options.xtce, exit_code);
    if (!recorded) return exit_code;
    const auto found = [&] {
        ProgressLine line;
        return pipeline::verify(options.archive, asked(options), recorded->dictionary, recorded->other.get(),
                                std::filesystem::temp_directory_path(), until_interrupted(line), *known);
    }();
    if (!found) return failed_at("verify", found.error());
    if (found->stopped) return failed("archive verify: stopped before everything was compared");
    if (!*known && found->faults.empty())
        fmt::print("note: audit: no head was kept outside the archive, so a cut-off end would not show\n");
    for (const auto& fault : found->faults) fmt::print("{}\n", fault);
    for (const auto& note : found->notes) fmt::print("note: {}\n", note);
    fmt::print("{}: {} runs, {} packets compared, {}\n", options.archive.string(), found->runs, found->packets,
               found->faults.empty() ? "nothing wrong" : fmt::format("{} faults", found->faults.size()));
    return found->faults.empty() ? 0 : 1;
}

/// Returns 0 when every run was rebuilt.
int archive_rebuild(const ArchiveOptions& options) {
    int exit_code = 0;
    const auto recorded = recorded_dictionary(options.shared.dictionary, options.xtce, exit_code);
    if (!recorded) return exit_code;
    const auto rebuilt = [&] {
        ProgressLine line;
        return pipeline::rebuild(options.archive, asked(options), recorded->dictionary, recorded->other.get(),
                                 by_this_user(), until_interrupted(line));
    }();
    if (!rebuilt) return failed_at("rebuild", rebuilt.error());
    for (const auto& run : rebuilt->runs) fmt::print("run {}: rebuilt from its packets\n", run.value);
    for (const auto& left : rebuilt->left) fmt::print("unchanged: {}\n", left);
    if (rebuilt->stopped) return failed("archive rebuild: stopped; runs not named above are unchanged");
    return rebuilt->left.empty() ? 0 : 1;
}

int archive_prune(const PruneOptions& options) {
    if (options.runs.empty() == !options.keep)
        return failed("archive prune: --run or --keep must name the runs, not both", 2);
    auto archive = archive::Maintenance::open(options.archive);
    if (!archive)
        return failed(fmt::format("archive prune: {} (a server that serves it removes a run by DELETE /api/v1/runs/N)",
                                  archive.error().message));
    const auto all = archive::run_lines(archive->database());
    if (!all) return failed_at("prune", all.error());
    const auto runs = chosen(options, *all);
    if (!runs) return failed_at("prune", runs.error());
    std::vector<archive::RunId> numbers;
    for (const auto& run : *runs) {
        numbers.push_back(run.run);
        fmt::print("run {:>4}  {}  {}  {} ({}), {} packets\n", run.run.value, run.started, run.scenario, run.state,
                   run.outcome, run.packets);
    }
    if (!options.yes || runs->empty()) {
        fmt::print("{} of {} runs would be removed; {}\n", runs->size(), all->size(),
                   runs->empty() ? "nothing to do" : "--yes removes them");
        return 0;
    }
    if (auto done = archive::prune(*archive, numbers, by_this_user()); !done) return failed_at("prune", done.error());
    std::error_code ignored;
    fmt::print("{} of {} runs removed; {}: {} octets\n", runs->size(), all->size(), options.archive.string(),
               std::filesystem::file_size(options.archive, ignored));
    return 0;
}

int archive_vacuum(const std::filesystem::path& file) {
    auto archive = archive::Maintenance::open(file);
    if (!archive) return failed_at("vacuum", archive.error());
    std::error_code ignored;
    const auto before = std::filesystem::file_size(file, ignored);
    if (auto done = archive::vacuum(*archive); !done) return failed_at("vacuum", done.error());
    fmt::print("{}: {} octets, before {}\n", file.string(), std::filesystem::file_size(file, ignored), before);
    return 0;
}

int archive_backup(const std::filesystem::path& file, const std::filesystem::path& copy) {
    if (auto done = archive::backup(file, copy); !done) return failed_at("backup", done.error());
    std::error_code ignored;
    fmt::print("{}: {} octets, all of {} as it was\n", copy.string(), std::filesystem::file_size(copy, ignored),
               file.string());
    return 0;
}

/// Returns 0 when both hold the same.
int archive_compare(const CompareOptions& options) {
    const auto found = archive::compare(options.archive, options.with);
    if (!found) return failed_at("compare", found.error());
    for (const auto& difference : found->differences) fmt::print("{}\n", difference);
    fmt::print("{} and {}: {}\n", options.archive.string(), options.with.string(),
               found->differences.empty() ? fmt::format("the same {} rows of {} runs", found->rows, found->runs)
                                          : fmt::format("{} tables differ", found->differences.size()));
    return found->differences.empty() ? 0 : 1;
}

void add_archive_verify(CLI::App& archive, int& exit_code) {
    const auto options = std::make_shared<VerifyOptions>();
    auto& command = *archive.add_subcommand(
        "verify",
        "checks the file's structure, its audit, its sequence numbers, every derived row against the packets, "
        "and all other rows against the run's fingerprint; prints a line per fault; exit code 1 when there is one");
    add_archive_and_dictionary(command, *options);
    command.add_option(
        "--audit-head", options->head,
        "newest audit entry that is known to have existed: a file that the server keeps beside its accounts, or "
        "ENTRY:HASH from its log; if left out, the file ARCHIVE-audit, if it exists");
    command.add_option("--run", options->run, "only this run")->check(whole_number());
    command.callback([options, &exit_code] { exit_code = archive_verify(*options); });
}

void add_archive_rebuild(CLI::App& archive, int& exit_code) {
    const auto options = std::make_shared<ArchiveOptions>();
    auto& command =
        *archive.add_subcommand("rebuild", "derives everything again from the packets and replaces the stored rows; "
                                           "not while another program writes");
    add_archive_and_dictionary(command, *options);
    command.add_option("--run", options->run, "only this run")->check(whole_number());
    command.callback([options, &exit_code] { exit_code = archive_rebuild(*options); });
}

void add_archive_prune(CLI::App& archive, int& exit_code) {
    const auto options = std::make_shared<PruneOptions>();
    auto& command = *archive.add_subcommand("prune", "removes runs; without --yes it only names them");
    add_archive_file(command, options->archive);
    auto* runs = command.add_option("--run", options->runs, "numbers, separated by commas")
                     ->delimiter(',')
                     ->check(whole_number());
    command.add_option("--keep", options->keep, "number of the newest runs to keep; all others are removed")
        ->check(whole_number())
        ->excludes(runs);
    command.add_flag("--yes", options->yes, "remove them");
    command.callback([options, &exit_code] { exit_code = archive_prune(*options); });
}

void add_archive_vacuum(CLI::App& archive, int& exit_code) {
    const auto file = std::make_shared<std::filesystem::path>(default_archive);
    auto& command = *archive.add_subcommand(
        "vacuum", "returns the space of pruned runs to the disk; needs as much space again meanwhile");
    add_archive_file(command, *file);
    command.callback([file, &exit_code] { exit_code = archive_vacuum(*file); });
}

void add_archive_backup(CLI::App& archive, int& exit_code) {
    const auto options = std::make_shared<BackupOptions>();
    auto& command = *archive.add_subcommand(
        "backup", "copies the whole archive, as it is now, into a new file, also while another program writes");
    add_archive_file(command, options->archive);
    command.add_option("--out", options->copy, "new file")->required();
    command.callback([options, &exit_code] { exit_code = archive_backup(options->archive, options->copy); });
}

void add_archive_compare(CLI::App& archive, int& exit_code) {
    const auto options = std::make_shared<CompareOptions>();
    auto& command = *archive.add_subcommand(
        "compare", "compares every row of every run with another archive, such as a follower's, also while other "
                   "programs write; prints a line per table that differs; exit code 1 when there is one");
    add_archive_file(command, options->archive);
    command.add_option("--with", options->with, "the other file")->required()->check(CLI::ExistingFile);
    command.callback([options, &exit_code] { exit_code = archive_compare(*options); });
}

}  // namespace

void add_archive_command(CLI::App& program, int& exit_code) {
    auto& archive = *program.add_subcommand("archive", "checks and maintains an archive");
    archive.require_subcommand(1);
    add_archive_verify(archive, exit_code);
    add_archive_rebuild(archive, exit_code);
    add_archive_samples(archive, exit_code);
    add_archive_prune(archive, exit_code);
    add_archive_vacuum(archive, exit_code);
    add_archive_backup(archive, exit_code);
    add_archive_compare(archive, exit_code);
}

}  // namespace aeolis::server
