#include "server/archive/reader.hpp"
#include "server/archive/sample_table.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/recorded_words.hpp"
#include "server/cli/shipped_paths.hpp"

#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <iterator>
#include <memory>

namespace aeolis::server {
namespace {

/// Takes some thousands of rows at a time.
using TakeRows = std::function<Result<void>(std::span<const archive::ChannelValue>, Sclk entry, const dictionary::Dictionary&)>;

/// Asks for the samples, hands them on. @return the exit code
int each_row(const ExportOptions& options, const char* command, const TakeRows& take) {
    const auto said = [&](const Error& error) { return failed(fmt::format("{}: {}", command, error.message)); };
    int exit_code = 0;
    const auto words = recorded_words(options.of.shared.dictionary, options.of.xtce, exit_code);
    if (!words) return exit_code;
    auto reader = archive::Reader::open(options.of.archive, words->dictionary, words->other.get());
    if (!reader) return said(reader.error());
    const archive::RunId run{options.of.run.value_or(0)};
    const auto state = reader->run(run);
    if (!state) return said(state.error());
    const auto done = reader->each_sample(run, options.channels, {options.from_s, options.to_s},
                                          [&](auto samples) { return take(samples, Sclk{state->entry_sclk()}, words->dictionary); });
    return done ? 0 : said(done.error());
}

const char* name_of(archive::Source source) {
    return source == archive::Source::realtime ? "realtime" : "recorded";
}

/// JSON has no infinities: they are texts.
std::string json_number(double value) {
    return std::isfinite(value) ? fmt::format("{}", value) : value > 0 ? "\"Infinity\"" : "\"-Infinity\"";
}

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

} // namespace

int export_samples(const ExportOptions& options) {
    std::unique_ptr<std::FILE, CloseFile> file;
    if (!options.out.empty()) {
        file.reset(std::fopen(options.out.c_str(), "wx"));
        if (file == nullptr) return failed(fmt::format("export: {} cannot be made, or is there already", options.out.string()));
    }
    std::FILE* const to = file != nullptr ? file.get() : stdout;
    const auto write = [&](const fmt::memory_buffer& text) -> Result<void> {
        if (std::fwrite(text.data(), 1, text.size(), to) == text.size()) return {};
        return Error{(file != nullptr ? options.out.string() : std::string("the standard output")) + " takes no more"};
    };
    const bool csv = options.format == "csv";
    fmt::memory_buffer text;
    bool head = csv;
    const int ended = each_row(options, "export", [&](auto samples, Sclk entry, const auto& dictionary) {
        text.clear();
        const auto into = std::back_inserter(text);
        if (std::exchange(head, false)) fmt::format_to(into, "sclk,e_s,channel,value,unit,source\n");
        for (const auto& sample : samples) {
            const auto& channel = dictionary.channels[sample.channel.value];
            const double sclk_s = sample.sclk.seconds, e_s = sclk_s - entry.seconds;
            if (csv)
                fmt::format_to(into, "{},{},{},{},{},{}\n", sclk_s, e_s, channel.name, sample.value, channel.type.unit, name_of(sample.source));
            else
                fmt::format_to(into, R"({{"sclk":{},"e_s":{},"channel":"{}","value":{},"unit":"{}","source":"{}"}})"
                                     "\n",
                               sclk_s, e_s, channel.name, json_number(sample.value), channel.type.unit, name_of(sample.source));
        }
        return write(text);
    });
    if (ended != 0) return ended;
    if (head) std::fputs("sclk,e_s,channel,value,unit,source\n", to);
    return std::fflush(to) == 0 ? 0 : failed("export: what was written could not be kept");
}

int archive_samples(const ExportOptions& options) {
    auto table = archive::SampleTable::create(options.out);
    if (!table) return failed("archive samples: " + table.error().message);
    const archive::RunId run{options.of.run.value_or(0)};
    std::size_t rows = 0;
    const int ended = each_row(options, "archive samples", [&](auto samples, Sclk entry, const auto& dictionary) {
        rows += samples.size();
        return table->add(run, entry, dictionary, samples);
    });
    if (ended != 0) return ended;
    if (auto done = table->finish(); !done) return failed("archive samples: " + done.error().message);
    fmt::print("{} samples of run {} are the table 'samples' of {}\n", rows, run.value, options.out.string());
    return 0;
}

} // namespace aeolis::server
