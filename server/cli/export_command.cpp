// SPDX-License-Identifier: Apache-2.0
#include "server/api/sample_text.hpp"
#include "server/archive/reader.hpp"
#include "server/archive/sample_table.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/options.hpp"
#include "server/cli/recorded_dictionary.hpp"
#include "server/cli/shipped_paths.hpp"

#include <cstdio>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <utility>

namespace aeolis::server {
namespace {

struct ExportOptions {
    ArchiveOptions of;
    std::vector<std::string> channels;   ///< empty: all
    std::optional<double> from_s, to_s;  ///< SCLK, both included
    std::string format = "csv";          ///< csv, jsonl
    std::string align;                   ///< as in SampleText::Options
    std::filesystem::path out;           ///< empty: standard output
};

using Begin = std::function<Result<void>(const v1::RunState&, const dictionary::Dictionary&)>;

/// Calls `begin` with the run and its dictionary, then passes its samples on, some thousands at a time. @return the
/// exit code
int each_row(const ExportOptions& options, const char* command, const Begin& begin,
             const archive::Reader::TakeSamples& take) {
    const auto said = [&](const Error& error) { return failed(fmt::format("{}: {}", command, error.message)); };
    int exit_code = 0;
    const auto recorded = recorded_dictionary(options.of.shared.dictionary, options.of.xtce, exit_code);
    if (!recorded) return exit_code;
    auto reader = archive::Reader::open(options.of.archive, recorded->dictionary, recorded->other.get());
    if (!reader) return said(reader.error());
    const archive::RunId run{options.of.run.value_or(0)};
    const auto state = reader->run(run);
    if (!state) return said(state.error());
    if (auto begun = begin(*state, recorded->dictionary); !begun) return said(begun.error());
    const auto done = reader->each_sample(run, options.channels, {options.from_s, options.to_s}, take);
    return done ? 0 : said(done.error());
}

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

/// Writes one line per sample, or per instant.
int export_samples(const ExportOptions& options) {
    std::unique_ptr<std::FILE, CloseFile> file;
    if (!options.out.empty()) {
        file.reset(std::fopen(options.out.c_str(), "wx"));
        if (file == nullptr)
            return failed(fmt::format("export: {} cannot be made, or is there already", options.out.string()));
    }
    std::FILE* const to = file != nullptr ? file.get() : stdout;
    const auto write = [&](std::string_view text) -> Result<void> {
        if (std::fwrite(text.data(), 1, text.size(), to) == text.size()) return {};
        return Error{(file != nullptr ? options.out.string() : std::string("the standard output")) + " takes no more"};
    };
    std::optional<SampleText> lines;  // made once the run's dictionary is known
    std::string text;
    const int ended = each_row(
        options, "export",
        [&](const auto& state, const auto& dictionary) -> Result<void> {
            auto made = SampleText::make(dictionary, options.channels, {options.format, options.align});
            if (!made) return made.error();
            lines = std::move(*made);
            lines->set_entry(Sclk{state.entry_sclk()});
            return write(lines->head());
        },
        [&](auto samples) {
            text.clear();
            lines->append(text, samples);
            return write(text);
        });
    if (ended != 0) return ended;
    text.clear();
    lines->finish(text);
    if (auto done = write(text); !done) return failed("export: " + done.error().message);
    return std::fflush(to) == 0 ? 0 : failed("export: what was written could not be kept");
}

/// Writes the same samples as a table of an SQLite file `out`.
int archive_samples(const ExportOptions& options) {
    auto table = archive::SampleTable::create(options.out);
    if (!table) return failed("archive samples: " + table.error().message);
    const archive::RunId run{options.of.run.value_or(0)};
    std::size_t rows = 0;
    Sclk entry;
    const dictionary::Dictionary* words = nullptr;
    const int ended = each_row(
        options, "archive samples",
        [&](const auto& state, const auto& dictionary) -> Result<void> {
            entry = Sclk{state.entry_sclk()};
            words = &dictionary;
            return {};
        },
        [&](auto samples) {
            rows += samples.size();
            return table->add(run, entry, *words, samples);
        });
    if (ended != 0) return ended;
    if (auto done = table->finish(); !done) return failed("archive samples: " + done.error().message);
    fmt::print("{} samples of run {} are the table 'samples' of {}\n", rows, run.value, options.out.string());
    return 0;
}

/// Adds the options that select samples of a run.
void add_selection(CLI::App& command, ExportOptions& options) {
    add_archive_and_dictionary(command, options.of);
    command.add_option("--run", options.of.run, "number of the run")->required()->check(whole_number());
    command
        .add_option("--channel,--channels", options.channels,
                    "names or aliases, separated by blanks or commas; all if left out")
        ->delimiter(',');
    command.add_option("--from", options.from_s, "first SCLK [s]");
    command.add_option("--to", options.to_s, "last SCLK [s]");
}

}  // namespace

void add_export_command(CLI::App& program, int& exit_code) {
    const auto options = std::make_shared<ExportOptions>();
    auto& command =
        *program.add_subcommand("export", "prints a run's samples in order of SCLK, live and recorded as one series, a "
                                          "row a sample");
    add_selection(command, *options);
    auto* format = command.add_option("--format", options->format, "csv or jsonl")
                       ->check(CLI::IsMember({"csv", "jsonl"}))
                       ->capture_default_str();
    command.add_flag("--csv")->description("as CSV, the default")->excludes(format);
    command.add_option("--align", options->align,
                       "print a line an instant and a column a channel, each with its newest value: at the "
                       "times of the named channel, or at multiples of so many seconds");
    command.add_option("--out", options->out, "new file; standard output if left out");
    command.callback([options, &exit_code] { exit_code = export_samples(*options); });
}

void add_archive_samples(CLI::App& archive, int& exit_code) {
    const auto options = std::make_shared<ExportOptions>();
    auto& command =
        *archive.add_subcommand("samples", "writes a run's samples as rows of an SQLite file, for plain SQL");
    add_selection(command, *options);
    command.add_option("--out", options->out, "new file")->required();
    command.callback([options, &exit_code] { exit_code = archive_samples(*options); });
}

}  // namespace aeolis::server
