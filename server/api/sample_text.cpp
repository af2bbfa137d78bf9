#include "server/api/sample_text.hpp"

#include <cmath>
#include <fmt/format.h>
#include <iterator>

namespace aeolis::server {
namespace {

const char* word_for(archive::Source source) {
    return source == archive::Source::realtime ? "realtime" : "recorded";
}

std::string json_number(double value) {
    return std::isfinite(value) ? fmt::format("{}", value) : value > 0 ? "\"Infinity\"" : "\"-Infinity\"";
}

} // namespace

Result<RowFormat> row_format(std::string_view name) {
    if (name == "csv") return RowFormat::csv;
    if (name == "jsonl") return RowFormat::jsonl;
    return Error{fmt::format("format: '{}' is neither csv nor jsonl", name)};
}

std::string_view head_of(RowFormat format) {
    return format == RowFormat::csv ? "sclk,e_s,channel,value,unit,source\n" : "";
}

void append_rows(std::string& text, RowFormat format, std::span<const archive::ChannelValue> samples, Sclk entry,
                 const dictionary::Dictionary& dictionary) {
    const auto into = std::back_inserter(text);
    for (const auto& sample : samples) {
        const auto& channel = dictionary.channels[sample.channel.value];
        const double sclk_s = sample.sclk.seconds, e_s = sclk_s - entry.seconds;
        if (format == RowFormat::csv)
            fmt::format_to(into, "{},{},{},{},{},{}\n", sclk_s, e_s, channel.name, sample.value, channel.type.unit, word_for(sample.source));
        else
            fmt::format_to(into, R"({{"sclk":{},"e_s":{},"channel":"{}","value":{},"unit":"{}","source":"{}"}})"
                                 "\n",
                           sclk_s, e_s, channel.name, json_number(sample.value), channel.type.unit, word_for(sample.source));
    }
}

} // namespace aeolis::server
