// SPDX-License-Identifier: Apache-2.0
#include "server/api/sample_text.hpp"

#include "server/base/csv_text.hpp"
#include "server/base/json_object.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <iterator>

namespace aeolis::server {
namespace {

const char* word_for(archive::Source source) {
    return source == archive::Source::realtime ? "realtime" : "recorded";
}

/// A value as JSON: undefined is null; a text, and an infinity, which JSON lacks, are texts.
std::string json_of(const archive::ChannelValue& sample) {
    if (sample.text) return json_text(*sample.text);
    if (std::isnan(sample.value)) return "null";
    return std::isfinite(sample.value) ? json_number(sample.value)
           : sample.value > 0          ? "\"Infinity\""
                                       : "\"-Infinity\"";
}

/// A value as a cell of CSV; undefined is an empty one.
std::string csv_of(const archive::ChannelValue& sample) {
    if (sample.text) return csv_text(*sample.text);
    return std::isnan(sample.value) ? std::string{} : fmt::format("{}", sample.value);
}

std::optional<double> seconds_of(const std::string& text) {
    double seconds = 0.0;
    const auto* const end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data(), end, seconds);
    if (error != std::errc{} || stopped != end) return std::nullopt;
    return seconds;
}

/// The first whole multiple of `step_s` at or after `sclk_s`. For steps such as 0.1, the double nearest to the decimal
/// value, so that two files have equal times.
double next_step(double sclk_s, double step_s) {
    const double count = std::ceil(sclk_s / step_s), per_s = std::round(1.0 / step_s);
    return std::abs(per_s * step_s - 1.0) < 1e-12 ? count / per_s : count * step_s;
}

}  // namespace

SampleText::SampleText(const dictionary::Dictionary& dictionary, bool csv) : csv_(csv) {
    words_.reserve(dictionary.channels.size());
    for (const auto& channel : dictionary.channels)
        words_.push_back(csv ? Words{csv_text(channel.name), csv_text(channel.type.unit)}
                             : Words{json_text(channel.name), json_text(channel.type.unit)});
}

Result<SampleText> SampleText::make(const dictionary::Dictionary& dictionary, const std::vector<std::string>& channels,
                                    const Options& options) {
    if (options.format != "csv" && options.format != "jsonl")
        return Error{fmt::format("format: '{}' is neither csv nor jsonl", options.format)};
    SampleText text(dictionary, options.format == "csv");
    if (options.align.empty()) return text;
    if (channels.empty()) return Error{"align: the columns are the channels that are named, and none is"};
    for (const auto& name : channels) {
        const auto* channel = dictionary.channel(name);
        if (channel == nullptr) return Error{fmt::format("no channel '{}'", name)};
        if (std::ranges::find(text.columns_, channel) != text.columns_.end())
            return Error{fmt::format("channel '{}' is named twice", name)};
        text.columns_.push_back(channel);
        if (name == options.align) text.leader_ = channel;
    }
    text.values_.resize(channels.size());
    if (text.leader_ != nullptr) return text;
    const auto step_s = seconds_of(options.align);
    if (!step_s) return Error{fmt::format("align: '{}' is neither one of the channels nor seconds", options.align)};
    if (!(*step_s >= align_s_min && *step_s <= align_s_max))
        return Error{fmt::format("align: {} s is not within {} … {} s", *step_s, align_s_min, align_s_max)};
    text.step_s_ = *step_s;
    return text;
}

std::string SampleText::head() const {
    if (!csv_) return {};
    if (columns_.empty()) return "sclk,e_s,channel,value,unit,source\n";
    std::string line = "sclk,e_s";
    for (const auto* channel : columns_) line += ',' + words_[channel->id.value].name;
    return line + '\n';
}

void SampleText::append(std::string& text, std::span<const archive::ChannelValue> samples) {
    for (const auto& sample : samples) columns_.empty() ? append_sample(text, sample) : append_aligned(text, sample);
}

void SampleText::finish(std::string& text) {
    if (line_s_) append_line(text, *line_s_);
    line_s_.reset();
}

std::string SampleText::e_text(double sclk_s) const {
    if (entry_.seconds != 0.0) return fmt::format("{}", sclk_s - entry_.seconds);
    return csv_ ? "" : "null";
}

void SampleText::append_sample(std::string& text, const archive::ChannelValue& sample) const {
    const auto into = std::back_inserter(text);
    const auto& [channel, unit] = words_[sample.channel.value];
    const double sclk_s = sample.sclk.seconds;
    if (csv_)
        fmt::format_to(into, "{},{},{},{},{},{}\n", sclk_s, e_text(sclk_s), channel, csv_of(sample), unit,
                       word_for(sample.source));
    else
        fmt::format_to(into,
                       R"({{"sclk":{},"e_s":{},"channel":{},"value":{},"unit":{},"source":"{}"}})"
                       "\n",
                       sclk_s, e_text(sclk_s), channel, json_of(sample), unit, word_for(sample.source));
}

void SampleText::append_aligned(std::string& text, const archive::ChannelValue& sample) {
    const auto column = std::ranges::find(columns_, sample.channel, &dictionary::Channel::id);
    if (column == columns_.end()) return;
    const double sclk_s = sample.sclk.seconds;
    if (line_s_ && sclk_s > *line_s_) finish(text);  // all samples of that instant were appended
    values_[static_cast<std::size_t>(column - columns_.begin())] = csv_ ? csv_of(sample) : json_of(sample);
    if (leader_ == nullptr)
        line_s_ = next_step(sclk_s, step_s_);
    else if (sample.channel == leader_->id)
        line_s_ = sclk_s;
}

void SampleText::append_line(std::string& text, double sclk_s) const {
    const auto into = std::back_inserter(text);
    if (csv_)
        fmt::format_to(into, "{},{}", sclk_s, e_text(sclk_s));
    else
        fmt::format_to(into, R"({{"sclk":{},"e_s":{})", sclk_s, e_text(sclk_s));
    for (std::size_t i = 0; i < columns_.size(); ++i) {
        if (csv_)
            text += ',' + values_[i].value_or("");
        else
            fmt::format_to(into, ",{}:{}", words_[columns_[i]->id.value].name, values_[i].value_or("null"));
    }
    text += csv_ ? "\n" : "}\n";
}

}  // namespace aeolis::server
