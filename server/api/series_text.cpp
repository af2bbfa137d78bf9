// SPDX-License-Identifier: Apache-2.0
#include "server/api/series_text.hpp"

#include "server/base/csv_text.hpp"
#include "server/base/json.hpp"
#include "server/base/json_object.hpp"

#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <utility>

namespace aeolis::server {
namespace {

constexpr std::size_t octets_a_sample = 56;  // in JSON: an SCLK, a value and a source

template <typename Column, typename Append>
void append_column(std::string& json, const char* name, const Column& column, Append append) {
    fmt::format_to(std::back_inserter(json), ",\"{}\":[", name);
    bool first = true;
    for (const auto each : column) {
        if (!std::exchange(first, false)) json += ',';
        append(each);
    }
    json += ']';
}

void append_json(std::string& json, const v1::ChannelSeries& series) {
    fmt::format_to(std::back_inserter(json), R"({{"id":{},"name":{},"unit":{},"samples":"{}","thinned":{})",
                   series.id(), json_text(series.name()), json_text(series.unit()), series.samples(), series.thinned());
    const auto number = [&](double value) {
        if (std::isfinite(value))
            fmt::format_to(std::back_inserter(json), "{}", value);
        else
            json += std::isnan(value) ? R"("NaN")" : value > 0 ? R"("Infinity")" : R"("-Infinity")";
    };
    append_column(json, "sclk", series.sclk(), number);
    append_column(json, "value", series.value(), number);
    append_column(json, "source", series.source(), [&](int source) { json += '"' + v1::Source_Name(source) + '"'; });
    json += R"(,"origins":)" + json_array(series.origins(), to_json);
    json += R"(,"gaps":)" + json_array(series.gaps(), to_json) + '}';
}

}  // namespace

std::string series_json(const v1::ChannelSeriesList& list) {
    std::size_t samples = 0;
    for (const auto& series : list.channels()) samples += static_cast<std::size_t>(series.sclk_size());
    std::string json = R"({"channels":[)";
    json.reserve(json.size() + samples * octets_a_sample);
    for (int i = 0; i < list.channels_size(); ++i) {
        if (i > 0) json += ',';
        append_json(json, list.channels(i));
    }
    json += "]}";
    return json;
}

std::string series_csv(const v1::ChannelSeriesList& list) {
    std::string csv = "channel,unit,sclk_s,value,source\n";
    for (const auto& series : list.channels()) {
        const auto name = csv_text(series.name()), unit = csv_text(series.unit());  // a formula may contain commas
        for (int i = 0; i < series.sclk_size(); ++i)
            fmt::format_to(std::back_inserter(csv), "{},{},{},{},{}\n", name, unit, series.sclk(i), series.value(i),
                           series.source(i) == v1::SOURCE_RECORDED ? "recorded" : "realtime");
    }
    return csv;
}

}  // namespace aeolis::server
