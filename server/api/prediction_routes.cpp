// SPDX-License-Identifier: Apache-2.0
#include "aeolis/v1/prediction.pb.h"
#include "server/api/api.hpp"
#include "server/api/channel_names.hpp"
#include "server/api/query_text.hpp"
#include "server/api/run_questions.hpp"
#include "server/archive/items.hpp"
#include "server/base/json.hpp"
#include "server/base/version.hpp"
#include "server/scenario/scenario_text.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>

// What the ground predicts of a run's landing: the nominal flight of its scenario, and the predicted silences.
namespace aeolis::server {
namespace {

constexpr std::array<std::string_view, 2> prediction_formats{"json", "protobuf"};
constexpr std::array<std::string_view, 2> predicted_by{"nominal", "shadow"};
/// With a sample a second of a flight of 40 minutes, this many channels are at most 8 MiB of JSON.
constexpr std::size_t predicted_channels_max = 64;

using Channels = std::vector<const dictionary::Channel*>;

Result<Channels> channels_of(const QueryText& query, const dictionary::Dictionary& dictionary) {
    const auto names = query.list("channels");
    if (names.size() > predicted_channels_max)
        return Error{fmt::format("channels: {} of them, at most {} at once", names.size(), predicted_channels_max)};
    Channels channels;
    for (const auto& name : names) {
        const auto channel = channel_named(dictionary, "channels", name);
        if (!channel) return channel.error();
        if (std::ranges::find(channels, *channel) == channels.end()) channels.push_back(*channel);
    }
    return channels;
}

std::string basis() {
    return fmt::format("the nominal flight of this scenario by Aeolis {}: without errors and faults, commands as "
                       "planned, parameters as built; silences by the plan, the passes and the nominal entry. It is "
                       "not the mission's own prediction",
                       version);
}

/// What the flight that ground kept beside the run, if it did, has of these channels by what was heard.
Result<v1::Prediction> by_shadow(archive::Reader& reader, archive::RunId run, bool kept, const Channels& channels,
                                 const archive::SclkRange& range) {
    v1::Prediction prediction;
    prediction.set_state("none");
    if (!kept) {
        prediction.set_reason("ground kept no flight beside this run: it began faster than 100 times real time, or its "
                              "scenario or the server refuses one");
        return prediction;
    }
    std::vector<ChannelId> ids;
    for (const auto* channel : channels) ids.push_back(channel->id);
    const auto expected = reader.expected_values(run, ids, range);
    if (!expected) return expected.error();
    prediction.set_state("ready");
    prediction.set_basis(fmt::format("the flight that ground kept beside the run, by Aeolis {}: by its solution, the "
                                     "commands that were sent and what was heard until each instant; moved to each "
                                     "state that the vehicle told, ten seconds apart at least",
                                     version));
    for (std::size_t i = 0; i < channels.size(); ++i) {
        auto& series = *prediction.add_channels();
        series.set_id(channels[i]->id.value);
        series.set_name(channels[i]->name);
        series.set_unit(channels[i]->type.unit);
        series.mutable_sclk()->Add((*expected)[i].sclk_s.begin(), (*expected)[i].sclk_s.end());
        series.mutable_value()->Add((*expected)[i].value.begin(), (*expected)[i].value.end());
        series.set_samples((*expected)[i].sclk_s.size());
    }
    return prediction;
}

/// Converts seconds from entry into the texts of the run's clocks.
struct RunClocks {
    const v1::RunState& run;
    ClockCorrelation clock = archive::correlation_of(run);

    Sclk sclk(double e_s) const { return Sclk{run.entry_sclk() + e_s}; }
    std::string scet(double e_s) const { return day_of_year_text(clock.scet_of(sclk(e_s))); }
    std::string ert(double e_s) const { return day_of_year_text(archive::ert_of(run, sclk(e_s))); }
};

void add_windows(const NominalFlight& flight, const RunClocks& clocks, v1::Prediction& prediction) {
    for (const auto& window : flight.windows) {
        auto& added = *prediction.add_windows();
        added.set_kind(window.pass ? "pass" : "silence");
        added.set_link(window.link);
        added.set_words(window.words);
        added.set_from_e_s(window.from_s);
        added.set_from_scet(clocks.scet(window.from_s));
        added.set_from_ert(clocks.ert(window.from_s));
        if (!window.to_s) continue;
        added.set_to_e_s(*window.to_s);
        added.set_to_scet(clocks.scet(*window.to_s));
        added.set_to_ert(clocks.ert(*window.to_s));
    }
}

void add_ellipse(const NominalFlight& flight, v1::Prediction& prediction) {
    if (!flight.ellipse) return;
    auto& ellipse = *prediction.mutable_ellipse();
    ellipse.set_major_m(flight.ellipse->major_m);
    ellipse.set_minor_m(flight.ellipse->minor_m);
    ellipse.set_azimuth_deg(flight.ellipse->azimuth_deg);
}

void add_series(const NominalFlight& flight, const dictionary::Channel& channel, const RunClocks& clocks,
                const archive::SclkRange& range, v1::Prediction& prediction) {
    auto& series = *prediction.add_channels();
    series.set_id(channel.id.value);
    series.set_name(channel.name);
    series.set_unit(channel.type.unit);
    for (const auto& sample : flight.samples[channel.id.value]) {
        const double sclk_s = clocks.sclk(sample.e_s).seconds;
        if ((range.from_s && sclk_s < *range.from_s) || (range.to_s && sclk_s > *range.to_s)) continue;
        series.add_sclk(sclk_s);
        series.add_value(sample.value);
    }
    series.set_samples(static_cast<std::uint64_t>(series.sclk_size()));
}

HttpResponse response_of(const v1::Prediction& prediction, std::string_view format) {
    if (format == "json") return json_response(prediction);
    return {200, "application/x-protobuf", "no-store", prediction.SerializeAsString()};
}

}  // namespace

void Api::prediction(const ApiRequest& call) {
    auto query = QueryText::parse(call.request.query, {"channels", "from", "to", "by", "format"});
    if (!query) return call.respond(error_response(400, query.error()));
    auto format = query->one_of("format", prediction_formats);
    if (!format) return call.respond(error_response(400, format.error()));
    const auto by = query->one_of("by", predicted_by);
    if (!by) return call.respond(error_response(400, by.error()));
    auto channels = channels_of(*query, parts_.dictionary);
    if (!channels) return call.respond(error_response(400, channels.error()));
    ask(
        call, std::move(*query),
        [this, shadow = *by == "shadow", format = std::move(*format), channels = std::move(*channels)](
            archive::Reader& reader, archive::RunId id, const QueryText& asked) -> std::optional<HttpResponse> {
            const auto range = range_of(asked, reader, id);
            if (!range) return error_response(400, range.error());
            const auto run = reader.run(id);
            if (!run) return error_response(400, run.error());
            v1::Prediction prediction;
            prediction.set_dictionary_id(parts_.dictionary.id);
            prediction.set_state("none");
            const auto none = [&](const Error& why) {
                if (why.internal) return error_response(500, why);
                prediction.set_reason(why.message);
                return response_of(prediction, format);
            };
            const auto text = reader.scenario_text(id);
            if (!text) return none(text.error());
            const auto scenario = scenario_from_text(*text, fmt::format("the scenario of run {}", id.value));
            if (!scenario) return none(scenario.error());
            if (shadow) {
                auto expected = by_shadow(reader, id, scenario->ground_flight.value_or(false), channels, *range);
                if (!expected) return error_response(500, expected.error());
                expected->set_dictionary_id(parts_.dictionary.id);
                return response_of(*expected, format);
            }
            const auto predicted = parts_.predictions.prediction(*scenario);
            if (!predicted.none.empty()) return none(Error{predicted.none});
            prediction.set_basis(basis());
            prediction.set_state(predicted.flight ? "ready" : "flying");
            if (!predicted.flight) return response_of(prediction, format);
            const auto& flight = *predicted.flight;
            const RunClocks clocks{*run};
            prediction.set_outcome(flight.outcome);
            for (const auto& event : flight.events) {
                auto& added = *prediction.add_events();
                added.set_name(event.name);
                added.set_timepoint(event.timepoint);
                added.set_e_s(event.e_s);
                added.set_scet(clocks.scet(event.e_s));
                added.set_ert(clocks.ert(event.e_s));
            }
            add_windows(flight, clocks, prediction);
            add_ellipse(flight, prediction);
            for (const auto* channel : channels) add_series(flight, *channel, clocks, *range, prediction);
            return response_of(prediction, format);
        },
        JobPriority::soon);
}

}  // namespace aeolis::server
