// SPDX-License-Identifier: Apache-2.0
#include "server/api/series_text.hpp"

#include "server/base/csv_text.hpp"
#include "server/base/json.hpp"
#include "server/base/json_object.hpp"

#include <array>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <utility>

namespace aeolis::server {
namespace {

constexpr std::size_t part_octets = 1 << 20;  // chosen: a part ends with the element that passes it

void append_number(std::string& json, double value) {
    if (std::isfinite(value))
        fmt::format_to(std::back_inserter(json), "{}", value);
    else
        json += std::isnan(value) ? "null" : value > 0 ? R"("Infinity")" : R"("-Infinity")";
}

/// A value as JSON: a number, or what a number does not hold as text; undefined is null.
void append_value(std::string& json, const v1::ChannelSeries& of, int i) {
    if (i >= of.text_size()) return append_number(json, of.value(i));
    json += of.text(i).has_text() ? json_text(of.text(i).text()) : "null";
}

std::string newest_text(const v1::NewestSample& newest) {
    std::string value;
    if (newest.has_text())
        value = json_text(newest.text());
    else
        append_number(value, newest.value());
    return fmt::format(R"({{"sclk":{},"value":{},"ert_us":"{}","sclk_by_reception":{}}})", newest.sclk(), value,
                       newest.ert_us(), newest.sclk_by_reception());
}

std::string csv_value(const v1::ChannelSeries& of, int i) {
    if (i < of.text_size()) return csv_text(of.text(i).text());
    return std::isnan(of.value(i)) ? std::string{} : fmt::format("{}", of.value(i));
}

struct SeriesColumn {
    std::string_view name;
    int (*size)(const v1::ChannelSeries&);
    void (*append)(std::string&, const v1::ChannelSeries&, int index);
};
using Series = v1::ChannelSeries;
constexpr std::array series_columns{
    SeriesColumn{"sclk", [](const Series& of) { return of.sclk_size(); },
                 [](std::string& json, const Series& of, int i) { append_number(json, of.sclk(i)); }},
    SeriesColumn{"value", [](const Series& of) { return of.value_size(); }, append_value},
    SeriesColumn{"source", [](const Series& of) { return of.source_size(); },
                 [](std::string& json, const Series& of, int i) { json += '"' + v1::Source_Name(of.source(i)) + '"'; }},
    SeriesColumn{"origins", [](const Series& of) { return of.origins_size(); },
                 [](std::string& json, const Series& of, int i) { json += to_json(of.origins(i)); }},
    SeriesColumn{"gaps", [](const Series& of) { return of.gaps_size(); },
                 [](std::string& json, const Series& of, int i) { json += to_json(of.gaps(i)); }},
};

}  // namespace

std::string SeriesText::head() const {
    switch (format_) {
    case SeriesFormat::json: return R"({"channels":[)";
    case SeriesFormat::csv: return "channel,unit,sclk_s,value,source\n";
    case SeriesFormat::protobuf: break;
    }
    return {};
}

std::string SeriesText::tail() const {
    return format_ == SeriesFormat::json ? "]}" : "";
}

void SeriesText::begin(v1::ChannelSeries series) {
    series_ = std::move(series);
    column_ = next_ = 0;
}

bool SeriesText::append(std::string& text) {
    if (format_ == SeriesFormat::json) return append_json(text);
    if (format_ == SeriesFormat::csv) return append_csv(text);
    v1::ChannelSeriesList list;  // such lists one after another are the list of all
    *list.add_channels() = std::move(series_);
    list.AppendToString(&text);
    return false;
}

bool SeriesText::append_json(std::string& text) {
    const auto full = text.size() + part_octets;
    if (column_ == 0 && next_ == 0)
        fmt::format_to(std::back_inserter(text), R"({}{{"id":{},"name":{},"unit":{},"samples":"{}","thinned":{})",
                       std::exchange(first_, false) ? "" : ",", series_.id(), json_text(series_.name()),
                       json_text(series_.unit()), series_.samples(), series_.thinned());
    for (; column_ < static_cast<int>(series_columns.size()); ++column_, next_ = 0) {
        const auto& column = series_columns[static_cast<std::size_t>(column_)];
        if (next_ == 0) fmt::format_to(std::back_inserter(text), ",\"{}\":[", column.name);
        for (; next_ < column.size(series_); ++next_) {
            if (next_ > 0 && text.size() >= full) return true;
            if (next_ > 0) text += ',';
            column.append(text, series_, next_);
        }
        text += ']';
    }
    if (series_.has_newest()) text += ",\"newest\":" + newest_text(series_.newest());
    text += '}';
    return false;
}

bool SeriesText::append_csv(std::string& text) {
    const auto full = text.size() + part_octets;
    const auto name = csv_text(series_.name()), unit = csv_text(series_.unit());  // a formula may contain commas
    for (; next_ < series_.sclk_size(); ++next_) {
        if (text.size() >= full) return true;
        fmt::format_to(std::back_inserter(text), "{},{},{},{},{}\n", name, unit, series_.sclk(next_),
                       csv_value(series_, next_),
                       series_.source(next_) == v1::SOURCE_RECORDED ? "recorded" : "realtime");
    }
    return false;
}

std::string series_text(SeriesFormat format, v1::ChannelSeriesList list) {
    SeriesText series{format};
    std::string text = series.head();
    for (auto& each : *list.mutable_channels()) {
        series.begin(std::move(each));
        while (series.append(text)) {
        }
    }
    return text + series.tail();
}

}  // namespace aeolis::server
