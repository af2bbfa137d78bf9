// SPDX-License-Identifier: Apache-2.0
#include "server/api/raw_export.hpp"
#include "server/api/sample_text.hpp"
#include "server/archive/reader.hpp"
#include "server/archive/run_instant.hpp"
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
    std::vector<std::string> channels;        ///< empty: all
    std::optional<std::string> from{}, to{};  ///< both included: SCLK [s]; of raw octets and packets UTC of reception
    std::string format;                       ///< csv, jsonl; of raw octets and packets bin, pcap; empty: the first
    bool raw = false, packets = false;        ///< octets of links as they came; packets found in them
    std::string link;                         ///< of those; empty: all
    std::string align;                        ///< as in SampleText::Options
    std::filesystem::path out;                ///< empty: standard output
};

/// Reads an end of a range of samples; none when left out.
Result<std::optional<double>> sclk_of(const char* name, const std::optional<std::string>& text,
                                      const v1::RunState& run) {
    if (!text) return std::optional<double>{};
    const auto sclk = archive::instant_of(*text, run, name);
    if (!sclk) return sclk.error();
    return std::optional{sclk->seconds};
}

/// Reads an end of a range of receptions; none when left out.
Result<std::optional<Ert>> ert_of(const char* name, const std::optional<std::string>& text, const v1::RunState& run) {
    if (!text) return std::optional<Ert>{};
    const auto ert = archive::reception_of(*text, archive::clocks_of(run), name);
    if (!ert) return ert.error();
    return std::optional{*ert};
}

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
    const auto from_s = sclk_of("--from", options.from, *state), to_s = sclk_of("--to", options.to, *state);
    if (!from_s || !to_s) return failed((from_s ? to_s : from_s).error().message, 2);
    if (auto begun = begin(*state, recorded->dictionary); !begun) return said(begun.error());
    const auto done = reader->each_sample(run, options.channels, {*from_s, *to_s}, take);
    return done ? 0 : said(done.error());
}

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

/// The new file that is written, or the standard output.
class Output {
  public:
    Result<void> open(const std::filesystem::path& name) {
        if (name.empty()) return {};
        name_ = name.string();
        file_.reset(std::fopen(name.c_str(), "wx"));
        if (file_ != nullptr) return {};
        return Error{name_ + " cannot be made, or is there already"};
    }
    Result<void> write(std::string_view text) {
        if (std::fwrite(text.data(), 1, text.size(), to()) == text.size()) return {};
        return Error{name_ + " cannot be written further"};
    }
    Result<void> finish() {
        if (std::fflush(to()) == 0) return {};
        return Error{"the data could not be written completely"};
    }

  private:
    std::FILE* to() const { return file_ != nullptr ? file_.get() : stdout; }
    std::string name_ = "the standard output";
    std::unique_ptr<std::FILE, CloseFile> file_;
};

/// Writes octets of links, or the packets found in them.
int export_raw(const ExportOptions& options) {
    const auto said = [](const Error& error) { return failed("export: " + error.message); };
    int exit_code = 0;
    const auto recorded = recorded_dictionary(options.of.shared.dictionary, options.of.xtce, exit_code);
    if (!recorded) return exit_code;
    auto reader = archive::Reader::open(options.of.archive, recorded->dictionary, recorded->other.get());
    if (!reader) return said(reader.error());
    const archive::RunId run{options.of.run.value_or(0)};
    const auto state = reader->run(run);
    if (!state) return said(state.error());
    const auto from = ert_of("--from", options.from, *state), to = ert_of("--to", options.to, *state);
    if (!from || !to) return failed((from ? to : from).error().message, 2);
    auto pages = RawExport::begin(*reader, run, {options.packets, options.link, *from, *to},
                                  options.format.empty() ? "bin" : options.format);
    if (!pages) return said(pages.error());
    Output output;
    if (auto opened = output.open(options.out); !opened) return said(opened.error());
    if (auto done = output.write(pages->head()); !done) return said(done.error());
    for (;;) {
        const auto page = pages->page(*reader);
        if (!page) return said(page.error());
        if (!*page) break;
        if (auto done = output.write(**page); !done) return said(done.error());
    }
    if (auto done = output.finish(); !done) return said(done.error());
    if (options.packets || pages->octets_removed() == 0) return 0;
    return failed(fmt::format("export: {} octets before are no longer kept", pages->octets_removed()));
}

/// Writes one line per sample, or per instant.
int export_samples(const ExportOptions& options) {
    Output output;
    if (auto opened = output.open(options.out); !opened) return failed("export: " + opened.error().message);
    const auto write = [&](std::string_view text) { return output.write(text); };
    std::optional<SampleText> lines;  // made once the run's dictionary is known
    std::string text;
    const int ended = each_row(
        options, "export",
        [&](const auto& state, const auto& dictionary) -> Result<void> {
            auto made = SampleText::make(dictionary, options.channels,
                                         {options.format.empty() ? "csv" : options.format, options.align});
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
    const auto finished = output.finish();
    return finished ? 0 : failed("export: " + finished.error().message);
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
    command.add_option("--from", options.from,
                       "first instant: SCLK [s], SCET, ert:UTC, or E+4:58; for raw octets and packets the time "
                       "of reception: UTC, or one of those, a light time later");
    command.add_option("--to", options.to, "last instant, likewise");
}

}  // namespace

void add_export_command(CLI::App& program, int& exit_code) {
    const auto options = std::make_shared<ExportOptions>();
    auto& command =
        *program.add_subcommand("export", "prints a run's samples in order of SCLK, live and recorded as one series, a "
                                          "row per sample; or the octets of its links as received (--raw), or the "
                                          "packets found in them (--packets)");
    add_selection(command, *options);
    auto* format = command
                       .add_option("--format", options->format,
                                   "for samples csv (the default) or jsonl; for raw octets and packets bin (the "
                                   "default: the octets alone) or pcap (UDP datagrams with their times, from port 4200 "
                                   "on, a port per link)")
                       ->check(CLI::IsMember({"csv", "jsonl", "bin", "pcap"}));
    auto* raw = command.add_flag("--raw", options->raw, "print octets of links as received, good and bad");
    command.add_flag("--packets", options->packets, "print packets, in the order of reception")->excludes(raw);
    command.add_option("--link", options->link, "raw octets or packets of this link only");
    command.add_flag("--csv")->description("as CSV, the default")->excludes(format);
    command.add_option("--align", options->align,
                       "print a line per instant and a column per channel, each with its newest value: at the "
                       "times of the named channel, or at multiples of this many seconds");
    command.add_option("--out", options->out, "new file; standard output if left out");
    command.callback([options, &exit_code] {
        const bool raw_format = options->format == "bin" || options->format == "pcap";
        if (options->raw || options->packets) {
            const bool samples =
                (!options->format.empty() && !raw_format) || !options->align.empty() || !options->channels.empty();
            exit_code = samples
                            ? failed("export: --raw and --packets take the formats bin and pcap, and no channels", 2)
                            : export_raw(*options);
        } else {
            exit_code = raw_format || !options->link.empty()
                            ? failed("export: bin, pcap and --link need --raw or --packets", 2)
                            : export_samples(*options);
        }
    });
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
