// SPDX-License-Identifier: Apache-2.0
#include "server/api/run_questions.hpp"

#include "commands/preconditions.hpp"
#include "commands/timeline_change.hpp"
#include "server/api/channel_names.hpp"
#include "server/api/limits_in_force.hpp"
#include "server/api/list_response.hpp"
#include "server/api/plan_state.hpp"
#include "server/api/query_text.hpp"
#include "server/api/rehearsal_score.hpp"
#include "server/api/series_text.hpp"
#include "server/api/state_at.hpp"
#include "server/api/stream_hub.hpp"
#include "server/api/time_texts.hpp"
#include "server/api/touchdown.hpp"
#include "server/archive/items.hpp"
#include "server/archive/run_differences.hpp"
#include "server/archive/run_instant.hpp"
#include "server/base/csv_text.hpp"
#include "server/base/json.hpp"
#include "server/pipeline/positions.hpp"
#include "telemetry/text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <functional>
#include <limits>
#include <map>

namespace aeolis::server {
namespace {

constexpr std::array<std::string_view, 3> series_formats{"json", "csv", "protobuf"};
constexpr std::array<std::string_view, 2> report_formats{"json", "csv"};

template <typename Message>
HttpResponse answer(Result<Message> result) {
    if (!result) return error_response(400, result.error());
    write_time_texts(*result);
    HttpResponse response;
    response.body = to_json(*result);
    return response;
}

/// The clock correlation between SCLK and SCET; none when unknown.
std::optional<ClockCorrelation> clock_of(archive::Reader& reader, archive::RunId run) {
    const auto state = reader.run(run);
    const auto clock = state ? archive::correlation_of(*state) : ClockCorrelation{};
    return clock.scet == Scet{} ? std::nullopt : std::optional{clock};
}

/// The requested format of a question.
std::string format_of(const QueryText& query, std::span<const std::string_view> formats) {
    return query.text("format").value_or(std::string{formats.front()});
}

constexpr ListPage::Limits rows_page{1'000, archive::rows_page_max};

struct Asking {
    archive::Reader& reader;
    archive::RunId run;
    const QueryText& query;
};
template <typename List>
HttpResponse answer_rows(const Asking& asking, Result<List> list, const Rows& rows) {
    if (!list) return error_response(400, list.error());
    write_time_texts(*list);
    const auto format = format_of(asking.query, list_formats);
    return list_response(format, std::move(*list), rows,
                         format == "csv" ? clock_of(asking.reader, asking.run) : std::nullopt);
}

Result<bool> flag_of(const QueryText& query, std::string_view name) {
    const auto text = query.text(name).value_or("false");
    if (text == "true" || text == "1") return true;
    if (text == "false" || text == "0") return false;
    return Error{fmt::format("{}: '{}' is neither true nor false", name, text)};
}

constexpr std::size_t item_page_max = 1'000;  // chosen; with all channels a page ends sooner when it is long
constexpr std::array<std::string_view, 2> item_formats{"json", "protobuf"};

/// A page of the items as the stream gives them, at full rate.
HttpResponse items(const AnswerContext& context, archive::Reader& reader, archive::RunId run, const QueryText& query) {
    StreamSelection selection;
    const auto names = query.list("names");
    selection.all_channels = names.empty();
    for (const auto& name : names) {
        const auto channel = channel_named(context.dictionary, "names", name);
        if (!channel) return error_response(400, channel.error());
        selection.channels.push_back((*channel)->id.value);
    }
    std::ranges::sort(selection.channels);
    const auto page = ListPage::of(query, {item_page_max, item_page_max});
    if (!page) return error_response(400, page.error());
    archive::Reader::ItemKinds kinds;
    if (selection.all_channels) kinds.octets_max = archive::page_octets_max;
    const bool newest_first = page->order == archive::Order::newest_first;
    auto read = newest_first ? reader.newest_items(run, page->after, page->limit, kinds)
                             : reader.items(run, page->after, page->limit, kinds);
    if (!read) return error_response(400, read.error());
    std::vector<ItemWithFacts> given;
    for (const auto& item : read->items) given.push_back({.item = &item, .facts = {}});
    v1::Batch batch;
    select_items(selection, 0.0, given, batch);
    read->items = {};  // before the text is made
    batch.set_run(run.value);
    batch.set_history(true);
    batch.set_after_seq(newest_first ? read->after : page->after);
    batch.set_complete_through(read->complete_through);
    const auto next = !read->more ? 0 : newest_first ? read->after + 1 : read->complete_through;
    HttpResponse response;
    response.fields.emplace_back("Aeolis-Next-After", std::to_string(next));
    if (format_of(query, item_formats) == "json") {
        response.body = to_json_by_rows(std::move(batch), "items");
    } else {
        response.content_type = "application/x-protobuf";
        response.body = batch.SerializeAsString();
    }
    return response;
}

HttpResponse run_itself(const AnswerContext&, archive::Reader& reader, archive::RunId run, const QueryText&) {
    return answer(reader.run(run));
}

Result<v1::ChannelSeriesList> derived(archive::Reader& reader, archive::RunId run, const std::string& expression,
                                      const archive::SeriesQuery& query) {
    auto series = reader.derived(run, expression, query.range, query.points);
    if (!series) return series.error();
    v1::ChannelSeriesList list;
    *list.add_channels() = std::move(*series);
    return list;
}

/// The samples of a series answer above which it is read and written channel by channel; 4 MB as JSON.
constexpr std::size_t whole_series_samples_max = 60'000;

/// Series that are too long to be held together, on their way to the client.
struct SeriesParts {
    archive::RunId run;
    archive::SeriesQuery query;
    std::vector<std::string> channels;  ///< not begun
    SeriesText text;
    bool in_series = false, ended = false;

    BodyPart next(archive::Reader& reader) {
        if (ended) return std::optional<std::string>{};
        if (!in_series && channels.empty()) {
            ended = true;
            return std::optional{text.tail()};
        }
        if (!in_series) {
            query.channels = {channels.front()};
            channels.erase(channels.begin());
            auto one = reader.series(run, query);
            if (!one) return one.error();
            text.begin(std::move(*one->mutable_channels(0)));
        }
        std::string part;
        in_series = text.append(part);
        return std::optional{std::move(part)};
    }
};

struct SeriesAnswer {
    SeriesFormat format{};
    const char* content_type = "";
};
SeriesAnswer series_answer(std::string_view format) {
    if (format == "csv") return {SeriesFormat::csv, "text/csv; charset=utf-8"};
    if (format == "protobuf") return {SeriesFormat::protobuf, "application/x-protobuf"};
    return {SeriesFormat::json, "application/json"};
}

/// Gives the first part now and the others as the client takes them.
HttpResponse in_parts(const AnswerContext& context, archive::Reader& reader, const std::shared_ptr<SeriesParts>& parts,
                      const char* content_type) {
    auto first = parts->next(reader);
    if (!first) return error_response(400, first.error());
    HttpResponse response{200, content_type, "no-store", parts->text.head() + first->value_or("")};
    response.next_part = context.in_parts([parts](archive::Reader& of_part) { return parts->next(of_part); });
    return response;
}

HttpResponse channels(const AnswerContext& context, archive::Reader& reader, archive::RunId run,
                      const QueryText& query) {
    archive::SeriesQuery series;
    series.channels = query.list("names");
    const auto expression = query.text("expression");
    if (expression && !series.channels.empty())
        return error_response(400, "names and expression: one of them, not both");
    if (!expression && series.channels.empty())
        return error_response(400, "names: which channels? names=altitude_m,speed_mps");
    if (series.channels.size() > archive::channels_max)
        return error_response(
            400, fmt::format("names: {} channels, at most {} at once", series.channels.size(), archive::channels_max));
    const auto range = range_of(query, reader, run);
    if (!range) return error_response(400, range.error());
    series.range = *range;
    const auto points = query.amount("points", archive::thinned_points_max);
    if (!points) return error_response(400, points.error());
    if (*points) series.points = static_cast<std::size_t>(**points);
    const auto format = format_of(query, series_formats);
    if (const auto source = query.text("source")) {
        if (*source != "realtime" && *source != "recorded")
            return error_response(400, fmt::format("source: '{}' is neither realtime nor recorded", *source));
        if (expression) return error_response(400, "source: of named channels only, not of an expression");
        series.source = *source == "realtime" ? archive::Source::realtime : archive::Source::recorded;
    }
    const auto provenance = flag_of(query, "provenance");
    if (!provenance) return error_response(400, provenance.error());
    if (*provenance && (expression || format == "csv"))
        return error_response(400, "provenance: of named channels only, as json or protobuf");
    series.provenance = *provenance;
    const auto [text_format, content_type] = series_answer(format);
    if (!expression) {
        auto size = reader.series_size(run, series);
        if (!size) return error_response(400, size.error());
        if (size->samples > whole_series_samples_max)
            return in_parts(context, reader,
                            std::make_shared<SeriesParts>(
                                SeriesParts{run, series, std::move(size->channels), SeriesText{text_format}}),
                            content_type);
    }
    auto result = expression ? derived(reader, run, *expression, series) : reader.series(run, series);
    if (!result) return error_response(400, result.error());
    if (expression && static_cast<std::size_t>(result->channels(0).sclk_size()) > whole_series_samples_max) {
        const auto parts = std::make_shared<SeriesParts>(SeriesParts{run, series, {}, SeriesText{text_format}});
        parts->text.begin(std::move(*result->mutable_channels(0)));
        parts->in_series = true;
        return in_parts(context, reader, parts, content_type);
    }
    return {200, content_type, "no-store", series_text(text_format, std::move(*result))};
}

HttpResponse packets(const AnswerContext& context, archive::Reader& reader, archive::RunId run,
                     const QueryText& query) {
    archive::PacketQuery packets;
    packets.name = query.text("name");
    const auto apid = query.count("apid", 0x7FF);
    if (!apid) return error_response(400, apid.error());
    if (*apid) {
        if (packets.name) return error_response(400, "apid and name: one of them, not both");
        std::vector<std::string> names;
        for (const auto& packet : context.dictionary.packets)
            if (packet.apid.value == **apid) names.push_back(packet.name);
        if (names.empty()) return error_response(400, fmt::format("apid: no packet has APID {}", **apid));
        if (names.size() > 1)
            return error_response(400, fmt::format("apid: {} packets share APID {}: use name=, as in name={}",
                                                   names.size(), **apid, names.front()));
        packets.name = names.front();
    }
    const auto range = range_of(query, reader, run);
    if (!range) return error_response(400, range.error());
    const auto page = ListPage::of(query, {100, archive::packets_page_max});
    if (!page) return error_response(400, page.error());
    packets.verdict = query.text("verdict").value_or("");
    if (!packets.verdict.empty() &&
        std::ranges::none_of(archive::verdicts, [&](const char* name) { return packets.verdict == name; }))
        return error_response(400, fmt::format("verdict: there is no '{}'; verdicts are {}", packets.verdict,
                                               fmt::join(archive::verdicts, ", ")));
    packets.range = *range;
    packets.after = page->after;
    packets.limit = page->limit;
    packets.order = page->order;
    return answer_rows({reader, run, query}, reader.packets(run, packets), {"packets"});
}

HttpResponse events(const AnswerContext&, archive::Reader& reader, archive::RunId run, const QueryText& query) {
    archive::EventQuery events;
    events.levels = query.list("level");
    using dictionary::EventLevel;
    constexpr std::array levels{EventLevel::fatal,     EventLevel::warning_hi,  EventLevel::warning_lo,
                                EventLevel::command,   EventLevel::activity_hi, EventLevel::activity_lo,
                                EventLevel::diagnostic};
    for (const auto& level : events.levels)
        if (std::ranges::none_of(levels, [&](EventLevel each) { return telemetry::name_of(each) == level; }))
            return error_response(400, fmt::format("level: there is no '{}'; levels are FATAL … DIAGNOSTIC", level));
    events.text = query.text("text").value_or("");
    const auto range = range_of(query, reader, run);
    if (!range) return error_response(400, range.error());
    const auto page = ListPage::of(query, rows_page);
    if (!page) return error_response(400, page.error());
    const auto duplicates = flag_of(query, "duplicates");
    if (!duplicates) return error_response(400, duplicates.error());
    events.range = *range;
    events.after = page->after;
    events.limit = page->limit;
    events.order = page->order;
    events.duplicates = *duplicates;
    return answer_rows({reader, run, query}, reader.events(run, events), {"events", {"event"}});
}

/// Whether flight can explain a decision of this name, according to the dictionary.
bool is_decision(const dictionary::Dictionary& dictionary, std::string_view name) {
    const auto* packet = dictionary.packet("Explanation");
    const auto field = packet == nullptr ? std::nullopt : telemetry::field_index(*packet, "decision");
    return field && std::ranges::any_of(packet->fields[*field].type.enumeration,
                                        [&](const dictionary::EnumValue& value) { return value.label == name; });
}

HttpResponse explanations(const AnswerContext& context, archive::Reader& reader, archive::RunId run,
                          const QueryText& query) {
    archive::ExplanationQuery explanations;
    explanations.decision = query.text("decision").value_or("");
    if (!explanations.decision.empty() && !is_decision(context.dictionary, explanations.decision))
        return error_response(400, fmt::format("decision: flight explains none called '{}'", explanations.decision));
    const auto range = range_of(query, reader, run);
    if (!range) return error_response(400, range.error());
    const auto page = ListPage::of(query, rows_page);
    if (!page) return error_response(400, page.error());
    const auto duplicates = flag_of(query, "duplicates");
    if (!duplicates) return error_response(400, duplicates.error());
    explanations.text = query.text("text").value_or("");
    explanations.range = *range;
    explanations.after = page->after;
    explanations.limit = page->limit;
    explanations.order = page->order;
    explanations.duplicates = *duplicates;
    return answer_rows({reader, run, query}, reader.explanations(run, explanations), {"explanations", {"explanation"}});
}

HttpResponse tones(const AnswerContext&, archive::Reader& reader, archive::RunId run, const QueryText& query) {
    const auto range = range_of(query, reader, run);
    if (!range) return error_response(400, range.error());
    const auto page = ListPage::of(query, {archive::rows_page_max, archive::rows_page_max});
    if (!page) return error_response(400, page.error());
    return answer_rows(
        {reader, run, query},
        reader.tones(run, {*range, query.text("text").value_or(""), page->after, page->limit, page->order}),
        {"tones", {"tone"}});
}

HttpResponse commands(const AnswerContext&, archive::Reader& reader, archive::RunId run, const QueryText& query) {
    const auto range = range_of(query, reader, run);
    if (!range) return error_response(400, range.error());
    const auto page = ListPage::of(query, {archive::commands_page_max, archive::commands_page_max});
    if (!page) return error_response(400, page.error());
    return answer_rows(
        {reader, run, query},
        reader.commands(run, {*range, query.text("text").value_or(""), page->after, page->limit, page->order}),
        {"commands"});
}

/// Changes of alarms, or their present states.
HttpResponse alarms(const AnswerContext& context, archive::Reader& reader, archive::RunId run, const QueryText& query) {
    const auto page = ListPage::of(query, rows_page);
    if (!page) return error_response(400, page.error());
    const auto state = query.text("state");
    if (!state)
        return answer_rows({reader, run, query}, reader.alarms(run, page->after, page->limit, page->order),
                           {"changes", {"alarm", "staleness", "alarm_action", "link"}});
    if (*state != "current")
        return error_response(
            400, fmt::format("state: '{}' is not known; state=current gives all that are not normal", *state));
    return answer_rows({reader, run, query}, reader.alarm_states(run, context.now), {"alarms"});
}

HttpResponse notes(const AnswerContext&, archive::Reader& reader, archive::RunId run, const QueryText& query) {
    const auto page = ListPage::of(query, rows_page);
    if (!page) return error_response(400, page.error());
    return answer_rows({reader, run, query},
                       reader.notes(run, {query.text("text").value_or(""), page->after, page->limit, page->order}),
                       {"notes", {"note"}});
}

/// Whether the run, or one that was forked from it or from which it was, may go on: all of them have one plan.
Result<bool> may_go_on(archive::Reader& reader, archive::RunId run) {
    std::map<std::uint64_t, v1::RunState> runs;
    archive::RunQuery query;
    do {
        auto page = reader.runs(query);
        if (!page) return page.error();
        for (auto& each : *page->mutable_runs()) runs[each.run()] = std::move(each);
        query.after = page->next_after();
    } while (query.after != 0);
    const auto root_of = [&](std::uint64_t of) {
        for (auto known = runs.find(of); known != runs.end() && known->second.has_forked_from(); known = runs.find(of))
            of = known->second.forked_from().run();
        return of;
    };
    const auto root = root_of(run.value);
    return std::ranges::any_of(runs, [&](const auto& each) {
        return each.second.state() != v1::RunState::finished && root_of(each.first) == root;
    });
}

/// What an instructor does is hidden from everybody else while the run, or a fork of it, goes on or can be continued.
std::optional<HttpResponse> hidden(const AnswerContext& context, archive::Reader& reader, archive::RunId run) {
    if (context.instructor) return std::nullopt;
    const auto going_on = may_go_on(reader, run);
    if (!going_on) return error_response(400, going_on.error());
    if (!*going_on) return std::nullopt;
    return error_response(403, "what an instructor does is told when the run and its forks are over; before, it needs "
                               "the right to instruct");
}

HttpResponse interventions(const AnswerContext& context, archive::Reader& reader, archive::RunId run,
                           const QueryText& query) {
    if (auto refusal = hidden(context, reader, run)) return std::move(*refusal);
    const auto page = ListPage::of(query, rows_page);
    if (!page) return error_response(400, page.error());
    return answer_rows({reader, run, query}, reader.interventions(run, {page->after, page->limit, page->order}),
                       {"interventions",
                        {"fault", "device_fault", "system_fault", "computer_reset", "station_outage", "orbiter_outage",
                         "uhf_loss", "wind_shift", "air_shift", "sensor_error", "false_tone", "note", "skipped"}});
}

HttpResponse plan(const AnswerContext& context, archive::Reader& reader, archive::RunId run, const QueryText&) {
    if (auto refusal = hidden(context, reader, run)) return std::move(*refusal);
    return answer(plan_state(reader, run, context.dictionary, context.plans));
}

std::optional<double> number_in(std::string_view text) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

/// The change of offsets by the command in the query, whose arguments are name=value.
Result<std::optional<dictionary::OffsetChange>> change_of(const dictionary::Dictionary& dictionary,
                                                          const QueryText& query) {
    const auto name = query.text("command");
    const auto given = query.list("arguments");
    if (!name && given.empty()) return std::optional<dictionary::OffsetChange>{};
    if (!name) return Error{"arguments: of which command? command=EDL_SET_TIMEPOINT_OFFSET"};
    const auto* command = dictionary.command(*name);
    if (command == nullptr) return Error{fmt::format("command: there is no '{}'", *name)};
    std::vector<commands::NamedValue> arguments;
    for (const auto& argument : given) {
        const auto equals = argument.find('=');
        const auto value =
            equals == std::string::npos ? std::nullopt : number_in(std::string_view{argument}.substr(equals + 1));
        if (!value) return Error{fmt::format("arguments: '{}' is not name=number", argument)};
        arguments.push_back({argument.substr(0, equals), *value});
    }
    return commands::offset_change(dictionary, *name, arguments);
}

/// Whether what only the recording brought counts.
Result<bool> recorded_of(const QueryText& query) {
    static constexpr std::array<std::string_view, 2> words{"true", "false"};
    const auto word = query.one_of("recorded", words);
    if (!word) return word.error();
    return *word == "true";
}

HttpResponse timepoints(const AnswerContext& context, archive::Reader& reader, archive::RunId run,
                        const QueryText& query) {
    const auto at = instant_of(query, "at", reader, run);
    if (!at) return error_response(400, at.error());
    const auto recorded = recorded_of(query);
    if (!recorded) return error_response(400, recorded.error());
    const auto change = change_of(context.dictionary, query);
    if (!change) return error_response(400, change.error());
    return answer_rows(
        {reader, run, query},
        reader.timepoints(run, {.at = *at, .now = context.now, .recorded = *recorded, .change = *change}),
        {"timepoints"});
}

/// The preconditions of a command, evaluated with the newest known values.
HttpResponse preconditions(const AnswerContext& context, archive::Reader& reader, archive::RunId run,
                           const QueryText& query) {
    const auto name = query.text("command").value_or("");
    const auto* command = context.dictionary.command(name);
    if (command == nullptr) return error_response(400, fmt::format("command: there is no '{}'", name));
    const auto at = instant_of(query, "at", reader, run);
    if (!at) return error_response(400, at.error());
    const auto state = reader.run(run);
    if (!state) return error_response(400, state.error());
    const auto values = reader.latest(run, *at);
    if (!values) return error_response(400, values.error());
    double now_s = 0.0;  // when unknown, no value counts as old
    if (*at)
        now_s = (*at)->seconds;
    else if (context.now)
        now_s = archive::sclk_at_ert(*state, *context.now).seconds;
    std::vector<commands::LatestValue> latest(context.dictionary.channels.size());
    for (const auto& value : *values)
        latest[value.channel.value] = {value.value, std::max(0.0, now_s - value.sclk.seconds)};
    v1::PreconditionList list;
    for (const auto& condition : commands::check(context.dictionary, *command, latest)) {
        auto& told = *list.add_preconditions();
        told.set_text(condition.text);
        told.set_state(commands::name_of(condition.verdict));
    }
    return answer(Result<v1::PreconditionList>{std::move(list)});
}

HttpResponse differences(const AnswerContext& context, archive::Reader& reader, archive::RunId run,
                         const QueryText& query) {
    const auto other = query.amount("with", std::numeric_limits<std::uint32_t>::max());
    if (!other) return error_response(400, other.error());
    if (!*other) return error_response(400, Error{"with: the number of the other run is wanted"});
    return answer(
        archive::differences(reader, context.dictionary, run, archive::RunId{static_cast<std::uint32_t>(**other)}));
}

HttpResponse limits(const AnswerContext& context, archive::Reader& reader, archive::RunId run, const QueryText& query) {
    const auto recorded = recorded_of(query);
    if (!recorded) return error_response(400, recorded.error());
    return answer(limits_in_force(reader, run, context.dictionary, *recorded));
}

HttpResponse touchdown_report(const AnswerContext& context, archive::Reader& reader, archive::RunId run,
                              const QueryText& query) {
    const auto at = instant_of(query, "at", reader, run);
    if (!at) return error_response(400, at.error());
    const auto recorded = recorded_of(query);
    if (!recorded) return error_response(400, recorded.error());
    return answer(touchdown(reader, run, context.dictionary, *at, context.now, *recorded));
}

/// The score tells what was injected, and so is hidden as that is.
HttpResponse score(const AnswerContext& context, archive::Reader& reader, archive::RunId run, const QueryText&) {
    const auto state = reader.run(run);
    if (!state) return error_response(400, state.error());
    if (!has_score(*state))  // before the report is made, which takes long
        return error_response(400, fmt::format("run {} has no score: it is no rehearsal that has finished", run.value));
    if (auto refusal = hidden(context, reader, run)) return std::move(*refusal);
    auto report = whole_report(reader, run);
    if (!report) return error_response(400, report.error());
    const auto rubric = context.plans.rubric();
    if (!rubric) return error_response(400, "no score without a rubric: " + rubric.error().message);
    return answer(rehearsal_score(reader, std::move(*report), context.dictionary, *rubric));
}

HttpResponse recording(const AnswerContext&, archive::Reader& reader, archive::RunId run, const QueryText&) {
    return answer(reader.recording(run));
}

HttpResponse staleness(const AnswerContext&, archive::Reader& reader, archive::RunId run, const QueryText&) {
    return answer(reader.recorded_staleness(run));
}

std::string csv_of(const v1::ProofReport& report) {
    std::string csv =
        "of,name,realtime,identical,differs,missing_in_recording,recorded,never_seen_live,not_decoded,pending\n";
    const auto add = [&](const char* of, const auto& rows) {
        for (const auto& row : rows)
            fmt::format_to(std::back_inserter(csv), "{},{},{},{},{},{},{},{},{},{}\n", of, row.name(), row.realtime(),
                           row.identical(), row.differs(), row.missing_in_recording(), row.recorded(),
                           row.never_seen_live(), row.not_decoded(), row.pending());
    };
    add("packet", report.streams());
    add("link", report.links());
    return csv;
}

/// Answers with JSON, or with a CSV table for format=csv.
template <typename Report>
HttpResponse answer_in_format(const QueryText& query, const std::function<Result<Report>()>& make,
                              std::string (*as_csv)(const Report&)) {
    auto report = make();
    if (format_of(query, report_formats) == "json" || !report) return answer(std::move(report));
    return {200, "text/csv; charset=utf-8", "no-store", as_csv(*report)};
}

HttpResponse proof(const AnswerContext&, archive::Reader& reader, archive::RunId run, const QueryText& query) {
    return answer_in_format<v1::ProofReport>(query, [&] { return reader.proof(run); }, csv_of);
}

/// The as-flown report; as CSV, its timepoints and events.
HttpResponse report(const AnswerContext&, archive::Reader& reader, archive::RunId run, const QueryText& query) {
    return answer_in_format<v1::AsFlownReport>(query, [&] { return reader.as_flown(run); }, as_flown_csv);
}

HttpResponse state(const AnswerContext& context, archive::Reader& reader, archive::RunId run, const QueryText& query) {
    const auto at = instant_of(query, "at", reader, run);
    if (!at) return error_response(400, at.error());
    auto found = state_at(reader, run, context.dictionary, *at);
    if (!found) return answer(std::move(found));
    // The channels as in /channels: JSON of Protobuf has no number that is undefined.
    v1::ChannelSeriesList channels;
    channels.mutable_channels()->Swap(found->mutable_channels());
    auto response = answer(std::move(found));
    constexpr std::string_view begin = R"({"channels":[])";
    if (!response.body.starts_with(begin)) return error_response(500, Error{"the state cannot be written as JSON"});
    auto with_channels = series_text(SeriesFormat::json, std::move(channels));
    with_channels.pop_back();  // its "}"
    response.body.replace(0, begin.size(), with_channels);
    return response;
}

HttpResponse procedures_of_run(const AnswerContext&, archive::Reader& reader, archive::RunId run,
                               const QueryText& query) {
    const auto at = instant_of(query, "at", reader, run);
    if (!at) return error_response(400, at.error());
    const auto state = reader.run(run);
    if (!state) return error_response(400, state.error());
    auto items = reader.procedures(run, *at ? std::optional{archive::ert_of(*state, **at)} : std::nullopt);
    if (!items) return error_response(400, items.error());
    v1::RunProcedureList list;
    for (auto& item : *items) *list.add_procedures() = std::move(item);
    return answer(Result<v1::RunProcedureList>{std::move(list)});
}

HttpResponse positions_of_run(const AnswerContext&, archive::Reader& reader, archive::RunId run,
                              const QueryText& query) {
    const auto at = instant_of(query, "at", reader, run);
    if (!at) return error_response(400, at.error());
    const auto state = reader.run(run);
    if (!state) return error_response(400, state.error());
    auto acts = reader.position_acts(run, *at ? std::optional{archive::ert_of(*state, **at)} : std::nullopt);
    if (!acts) return error_response(400, acts.error());
    v1::RunPositions answered;
    *answered.mutable_board() =
        acts->empty() ? pipeline::board_of(procedures::PositionBoard{}) : acts->back().position_act().board();
    for (auto& item : *acts) {
        item.mutable_position_act()->clear_board();  // of each of them it would be many times as long as the acts
        *answered.add_acts() = std::move(item);
    }
    return answer(Result<v1::RunPositions>{std::move(answered)});
}

const std::array questions{
    RunRoute{"", {}, {}, run_itself},
    RunRoute{"channels",
             {"names", "expression", "from", "to", "points", "source", "provenance", "format"},
             series_formats,
             channels},
    RunRoute{"packets",
             {"apid", "name", "from", "to", "verdict", "after", "limit", "order", "format"},
             list_formats,
             packets},
    RunRoute{"tones", {"text", "from", "to", "after", "limit", "order", "format"}, list_formats, tones},
    RunRoute{"items", {"names", "after", "limit", "order", "format"}, item_formats, items},
    RunRoute{"events",
             {"level", "text", "from", "to", "after", "limit", "order", "duplicates", "format"},
             list_formats,
             events},
    RunRoute{"commands", {"text", "from", "to", "after", "limit", "order", "format"}, list_formats, commands},
    RunRoute{"alarms", {"state", "after", "limit", "order", "format"}, list_formats, alarms},
    RunRoute{"notes", {"text", "after", "limit", "order", "format"}, list_formats, notes},
    RunRoute{"procedures", {"at"}, {}, procedures_of_run},
    RunRoute{"positions", {"at"}, {}, positions_of_run},
    RunRoute{"interventions", {"after", "limit", "order", "format"}, list_formats, interventions, true},
    RunRoute{"plan", {}, {}, plan, true},
    RunRoute{"preconditions", {"command", "at"}, {}, preconditions},
    RunRoute{"timepoints", {"at", "recorded", "command", "arguments", "format"}, list_formats, timepoints},
    RunRoute{"explanations",
             {"decision", "text", "from", "to", "after", "limit", "order", "duplicates", "format"},
             list_formats,
             explanations},
    RunRoute{"differences", {"with"}, {}, differences},
    RunRoute{"limits", {"recorded"}, {}, limits},
    RunRoute{"touchdown", {"at", "recorded"}, {}, touchdown_report},
    RunRoute{"recording", {}, {}, recording},
    RunRoute{"staleness", {}, {}, staleness},
    RunRoute{"proof", {"format"}, report_formats, proof},
    RunRoute{"report", {"format"}, report_formats, report},
    RunRoute{"score", {}, {}, score, true},
    RunRoute{"state", {"at"}, {}, state},
};

}  // namespace

std::string as_flown_csv(const v1::AsFlownReport& report) {
    std::string csv =
        "of,name,planned_e_s,predicted_e_s,tone_e_s,realtime_e_s,recorded_e_s,margin_s,tone,verdict,text\n";
    const auto cell = [](bool known, double value) { return known ? fmt::format("{:.6f}", value) : std::string{}; };
    for (const auto& row : report.timepoints())
        fmt::format_to(std::back_inserter(csv), "timepoint,{},{},{},{},{},{},{},{},{},\n", csv_text(row.name()),
                       cell(row.has_planned_e_s(), row.planned_e_s()),
                       cell(row.has_predicted_e_s(), row.predicted_e_s()), cell(row.has_tone_e_s(), row.tone_e_s()),
                       cell(row.has_realtime_e_s(), row.realtime_e_s()),
                       cell(row.has_recorded_e_s(), row.recorded_e_s()), cell(row.has_margin_s(), row.margin_s()),
                       row.tone(), row.verdict());
    for (const auto& row : report.events())
        fmt::format_to(std::back_inserter(csv), "event,{},,{},,{},{},,,,{}\n", csv_text(row.name()),
                       cell(row.has_predicted_e_s(), row.predicted_e_s()),
                       cell(row.has_realtime_e_s(), row.realtime_e_s()),
                       cell(row.has_recorded_e_s(), row.recorded_e_s()), csv_text(row.text()));
    return csv;
}

Result<std::optional<Sclk>> instant_of(const QueryText& query, std::string_view name, archive::Reader& reader,
                                       archive::RunId run) {
    const std::string text = query.text(name).value_or("");
    if (text.empty()) return std::optional<Sclk>{};
    const auto state = reader.run(run);
    if (!state) return state.error();
    const auto instant = archive::instant_of(text, *state, name);
    if (!instant) return instant.error();
    return std::optional{*instant};
}

Result<archive::SclkRange> range_of(const QueryText& query, archive::Reader& reader, archive::RunId run) {
    const auto from = instant_of(query, "from", reader, run);
    if (!from) return from.error();
    const auto to = instant_of(query, "to", reader, run);
    if (!to) return to.error();
    if (*from && *to && **from > **to)
        return Error{fmt::format("from {} is after to {}: the range is upside down", query.text("from").value_or(""),
                                 query.text("to").value_or(""))};
    const auto seconds = [](const std::optional<Sclk>& at) { return at ? std::optional{at->seconds} : std::nullopt; };
    return archive::SclkRange{seconds(*from), seconds(*to)};
}

const RunRoute* run_question(std::string_view name) {
    const auto* const found = std::ranges::find(questions, name, &RunRoute::name);
    return found == questions.end() ? nullptr : found;
}

std::string run_question_names() {
    std::string names;
    for (const auto& question : questions)
        if (!question.name.empty()) names += (names.empty() ? "" : ", ") + std::string{question.name};
    return names;
}

}  // namespace aeolis::server
