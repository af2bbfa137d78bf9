#include "server/api/run_questions.hpp"

#include "server/api/json.hpp"
#include "server/api/query_text.hpp"
#include "telemetry/text.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace aeolis::server {
namespace {

constexpr std::uint64_t seq_max = UINT64_MAX >> 1; // SQLite's integers are signed

template <typename Message>
HttpResponse answer(const Result<Message>& result) {
    if (!result) return error_response(400, result.error().message);
    HttpResponse response;
    response.body = to_json(*result);
    return response;
}

struct Page {
    archive::Sequence after = 0;
    std::size_t limit = 0;
};
Result<Page> page_of(const QueryText& query, std::size_t usual, std::size_t max) {
    const auto after = query.count("after", seq_max);
    if (!after) return after.error();
    const auto limit = query.count("limit", max);
    if (!limit) return limit.error();
    if (*limit && **limit == 0) return Error{"limit: 0 asks for nothing"};
    return Page{after->value_or(0), static_cast<std::size_t>(limit->value_or(usual))};
}

Result<bool> flag_of(const QueryText& query, std::string_view name) {
    const auto text = query.text(name).value_or("false");
    if (text == "true" || text == "1") return true;
    if (text == "false" || text == "0") return false;
    return Error{fmt::format("{}: '{}' is neither true nor false", name, text)};
}

HttpResponse run_itself(const Ground&, archive::Reader& reader, archive::RunId run, const QueryText&) {
    return answer(reader.run(run));
}

/// A row a sample; the reader of a spreadsheet or of a script wants no JSON.
std::string csv_of(const v1::ChannelSeriesList& list) {
    std::string csv = "channel,unit,sclk_s,value,source\n";
    for (const auto& series : list.channels()) {
        const auto name = series.name().find(',') == std::string::npos ? series.name() : '"' + series.name() + '"'; // a formula may have commas
        for (int i = 0; i < series.sclk_size(); ++i)
            fmt::format_to(std::back_inserter(csv), "{},{},{},{},{}\n", name, series.unit(), series.sclk(i),
                           series.value(i), series.source(i) == v1::SOURCE_RECORDED ? "recorded" : "realtime");
    }
    return csv;
}

Result<v1::ChannelSeriesList> derived(archive::Reader& reader, archive::RunId run, const std::string& expression,
                                      const archive::SeriesQuery& query) {
    auto series = reader.derived(run, expression, query.range, query.points);
    if (!series) return series.error();
    v1::ChannelSeriesList list;
    *list.add_channels() = std::move(*series);
    return list;
}

HttpResponse channels(const Ground&, archive::Reader& reader, archive::RunId run,
                      const QueryText& query) {
    archive::SeriesQuery series;
    series.channels = query.list("names");
    const auto expression = query.text("expression");
    if (expression && !series.channels.empty()) return error_response(400, "names and expression: one of them, not both");
    if (!expression && series.channels.empty()) return error_response(400, "names: which channels? names=altitude_m,speed_mps");
    if (series.channels.size() > archive::channels_max)
        return error_response(
            400, fmt::format("names: {} channels, at most {} at once", series.channels.size(), archive::channels_max));
    const auto range = range_of(query);
    if (!range) return error_response(400, range.error().message);
    series.range = *range;
    const auto points = query.count("points", archive::thinned_points_max);
    if (!points) return error_response(400, points.error().message);
    if (*points && **points == 0) return error_response(400, "points: 0 asks for nothing");
    if (*points) series.points = static_cast<std::size_t>(**points);
    const auto format = query.text("format").value_or("json");
    if (format != "json" && format != "csv" && format != "protobuf")
        return error_response(400, fmt::format("format: '{}' is none of json, csv, protobuf", format));
    const auto result = expression ? derived(reader, run, *expression, series) : reader.series(run, series);
    if (format == "json" || !result) return answer(result);
    if (format == "csv") return {200, "text/csv; charset=utf-8", "no-store", csv_of(*result)};
    return {200, "application/x-protobuf", "no-store", result->SerializeAsString()};
}

HttpResponse packets(const Ground& ground, archive::Reader& reader, archive::RunId run,
                     const QueryText& query) {
    archive::PacketQuery packets;
    packets.name = query.text("name");
    const auto apid = query.count("apid", 0x7FF);
    if (!apid) return error_response(400, apid.error().message);
    if (*apid) {
        if (packets.name) return error_response(400, "apid and name: one of them, not both");
        std::vector<std::string> names;
        for (const auto& packet : ground.dictionary.packets)
            if (packet.apid.value == **apid) names.push_back(packet.name);
        if (names.empty()) return error_response(400, fmt::format("apid: no packet has APID {}", **apid));
        if (names.size() > 1)
            return error_response(400, fmt::format("apid: {} packets share APID {}: use name=, as in name={}",
                                                   names.size(), **apid, names.front()));
        packets.name = names.front();
    }
    const auto range = range_of(query);
    if (!range) return error_response(400, range.error().message);
    const auto page = page_of(query, 100, archive::packets_page_max);
    if (!page) return error_response(400, page.error().message);
    packets.verdict = query.text("verdict").value_or("");
    if (!packets.verdict.empty() && std::ranges::none_of(archive::verdicts, [&](const char* name) { return packets.verdict == name; }))
        return error_response(400, fmt::format("verdict: there is no '{}'; verdicts are {}", packets.verdict,
                                               fmt::join(archive::verdicts, ", ")));
    packets.range = *range;
    packets.after = page->after;
    packets.limit = page->limit;
    return answer(reader.packets(run, packets));
}

HttpResponse events(const Ground&, archive::Reader& reader, archive::RunId run,
                    const QueryText& query) {
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
    const auto range = range_of(query);
    if (!range) return error_response(400, range.error().message);
    const auto page = page_of(query, 1'000, archive::rows_page_max);
    if (!page) return error_response(400, page.error().message);
    const auto duplicates = flag_of(query, "duplicates");
    if (!duplicates) return error_response(400, duplicates.error().message);
    events.range = *range;
    events.after = page->after;
    events.limit = page->limit;
    events.duplicates = *duplicates;
    return answer(reader.events(run, events));
}

/// The decisions that flight can explain, as the dictionary words them.
bool is_decision(const dictionary::Dictionary& dictionary, std::string_view name) {
    const auto* packet = dictionary.packet("Explanation");
    const auto field = packet == nullptr ? std::nullopt : telemetry::field_index(*packet, "decision");
    return field && std::ranges::any_of(packet->fields[*field].type.enumeration,
                                        [&](const dictionary::EnumValue& value) { return value.label == name; });
}

HttpResponse explanations(const Ground& ground, archive::Reader& reader, archive::RunId run,
                          const QueryText& query) {
    archive::ExplanationQuery explanations;
    explanations.decision = query.text("decision").value_or("");
    if (!explanations.decision.empty() && !is_decision(ground.dictionary, explanations.decision))
        return error_response(400, fmt::format("decision: flight explains none called '{}'", explanations.decision));
    const auto range = range_of(query);
    if (!range) return error_response(400, range.error().message);
    const auto page = page_of(query, 1'000, archive::rows_page_max);
    if (!page) return error_response(400, page.error().message);
    const auto duplicates = flag_of(query, "duplicates");
    if (!duplicates) return error_response(400, duplicates.error().message);
    explanations.text = query.text("text").value_or("");
    explanations.range = *range;
    explanations.after = page->after;
    explanations.limit = page->limit;
    explanations.duplicates = *duplicates;
    return answer(reader.explanations(run, explanations));
}

HttpResponse tones(const Ground&, archive::Reader& reader, archive::RunId run, const QueryText& query) {
    const auto range = range_of(query);
    if (!range) return error_response(400, range.error().message);
    return answer(reader.tones(run, *range));
}

HttpResponse commands(const Ground&, archive::Reader& reader, archive::RunId run, const QueryText& query) {
    return answer(reader.commands(run, query.text("text").value_or("")));
}

/// What happened to alarms; or how they stand now.
HttpResponse alarms(const Ground& ground, archive::Reader& reader, archive::RunId run, const QueryText& query) {
    const auto page = page_of(query, 1'000, archive::rows_page_max);
    if (!page) return error_response(400, page.error().message);
    const auto state = query.text("state");
    if (!state) return answer(reader.alarms(run, page->after, page->limit));
    if (*state != "current") return error_response(400, fmt::format("state: '{}' is not known; state=current gives all that are not normal", *state));
    return answer(reader.alarm_states(run, ground.now));
}

HttpResponse notes(const Ground&, archive::Reader& reader, archive::RunId run, const QueryText& query) {
    const auto page = page_of(query, 1'000, archive::rows_page_max);
    if (!page) return error_response(400, page.error().message);
    return answer(reader.notes(run, {query.text("text").value_or(""), page->after, page->limit}));
}

HttpResponse timepoints(const Ground&, archive::Reader& reader, archive::RunId run, const QueryText&) {
    return answer(reader.timepoints(run));
}

HttpResponse recording(const Ground&, archive::Reader& reader, archive::RunId run, const QueryText&) {
    return answer(reader.recording(run));
}

std::string csv_of(const v1::ProofReport& report) {
    std::string csv = "of,name,realtime,identical,differs,missing_in_recording,recorded,never_seen_live,not_decoded,pending\n";
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

HttpResponse proof(const Ground&, archive::Reader& reader, archive::RunId run, const QueryText& query) {
    const auto format = query.text("format").value_or("json");
    if (format != "json" && format != "csv")
        return error_response(400, fmt::format("format: '{}' is neither json nor csv", format));
    const auto report = reader.proof(run);
    if (format == "json" || !report) return answer(report);
    return {200, "text/csv; charset=utf-8", "no-store", csv_of(*report)};
}

std::string csv_of(const v1::AsFlownReport& report) {
    std::string csv = "timepoint,planned_e_s,predicted_e_s,tone_e_s,realtime_e_s,recorded_e_s,margin_s,tone,verdict\n";
    const auto cell = [](bool known, double value) { return known ? fmt::format("{:.6f}", value) : std::string{}; };
    for (const auto& row : report.timepoints())
        fmt::format_to(std::back_inserter(csv), "{},{},{},{},{},{},{},{},{}\n", row.name(), cell(row.has_planned_e_s(), row.planned_e_s()),
                       cell(row.has_predicted_e_s(), row.predicted_e_s()), cell(row.has_tone_e_s(), row.tone_e_s()),
                       cell(row.has_realtime_e_s(), row.realtime_e_s()), cell(row.has_recorded_e_s(), row.recorded_e_s()),
                       cell(row.has_margin_s(), row.margin_s()), row.tone(), row.verdict());
    return csv;
}

/// As CSV its timepoints alone.
HttpResponse report(const Ground&, archive::Reader& reader, archive::RunId run, const QueryText& query) {
    const auto format = query.text("format").value_or("json");
    if (format != "json" && format != "csv")
        return error_response(400, fmt::format("format: '{}' is neither json nor csv", format));
    const auto report = reader.as_flown(run);
    if (format == "json" || !report) return answer(report);
    return {200, "text/csv; charset=utf-8", "no-store", csv_of(*report)};
}

/// The newest value of every channel at an instant: a series of one sample each.
HttpResponse state(const Ground& ground, archive::Reader& reader, archive::RunId run,
                   const QueryText& query) {
    const auto at = query.number("at");
    if (!at) return error_response(400, at.error().message);
    const auto values = reader.latest(run, *at ? std::optional{Sclk{**at}} : std::nullopt);
    if (!values) return error_response(400, values.error().message);
    v1::ChannelSeriesList list;
    for (const auto& value : *values) {
        const auto& channel = ground.dictionary.channels[value.channel.value];
        auto& series = *list.add_channels();
        series.set_id(channel.id.value);
        series.set_name(channel.name);
        series.set_unit(channel.type.unit);
        series.set_samples(1);
        series.add_sclk(value.sclk.seconds);
        series.add_value(value.value);
        series.add_source(static_cast<v1::Source>(value.source));
    }
    HttpResponse response;
    response.body = to_json(list);
    return response;
}

const std::array questions{
    RunQuestionEntry{"", {}, run_itself},
    RunQuestionEntry{"channels", {"names", "expression", "from", "to", "points", "format"}, channels},
    RunQuestionEntry{"packets", {"apid", "name", "from", "to", "verdict", "after", "limit"}, packets},
    RunQuestionEntry{"tones", {"from", "to"}, tones},
    RunQuestionEntry{"events", {"level", "text", "from", "to", "after", "limit", "duplicates"}, events},
    RunQuestionEntry{"commands", {"text"}, commands},
    RunQuestionEntry{"alarms", {"state", "after", "limit"}, alarms},
    RunQuestionEntry{"notes", {"text", "after", "limit"}, notes},
    RunQuestionEntry{"timepoints", {}, timepoints},
    RunQuestionEntry{"explanations", {"decision", "text", "from", "to", "after", "limit", "duplicates"}, explanations},
    RunQuestionEntry{"recording", {}, recording},
    RunQuestionEntry{"proof", {"format"}, proof},
    RunQuestionEntry{"report", {"format"}, report},
    RunQuestionEntry{"state", {"at"}, state},
};

} // namespace

Result<archive::SclkRange> range_of(const QueryText& query) {
    const auto from = query.number("from");
    if (!from) return from.error();
    const auto to = query.number("to");
    if (!to) return to.error();
    if (*from && *to && **from > **to)
        return Error{fmt::format("from {} is after to {}: the range is upside down", **from, **to)};
    return archive::SclkRange{*from, *to};
}

const RunQuestionEntry* run_question(std::string_view name) {
    const auto* const found = std::ranges::find(questions, name, &RunQuestionEntry::name);
    return found == questions.end() ? nullptr : found;
}

std::string run_question_names() {
    std::string names;
    for (const auto& question : questions)
        if (!question.name.empty()) names += (names.empty() ? "" : ", ") + std::string{question.name};
    return names;
}

} // namespace aeolis::server
