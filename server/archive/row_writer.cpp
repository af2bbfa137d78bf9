// SPDX-License-Identifier: Apache-2.0
#include "server/archive/row_writer.hpp"

#include "server/archive/pyramid.hpp"
#include "server/archive/schema.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::archive {

namespace {

/// NaN has no place in SQL: it becomes NULL.
void bind_number(sqlite::Statement& statement, int parameter, double value) {
    if (std::isnan(value))
        statement.bind_null(parameter);
    else
        statement.bind(parameter, value);
}

template <typename Records, typename Write>
Result<void> each(const Records& records, Write write) {
    for (const auto& record : records)
        if (auto done = write(record); !done) return done;
    return {};
}

std::int64_t number(std::uint64_t value) {
    return static_cast<std::int64_t>(value);
}

}  // namespace

Result<RowWriter> RowWriter::open(sqlite::Database& database) {
    RowWriter writer;
    const std::pair<sqlite::Statement RowWriter::*, const char*> statements[] = {
        {&RowWriter::unit_, "INSERT INTO units VALUES (?,?,?,?,?,?,?,?,?,?,?,?)"},
        {&RowWriter::event_, "INSERT INTO events VALUES (?,?,?,?,?,?,?,?,?,?)"},
        {&RowWriter::tone_, "INSERT INTO tones VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?)"},
        {&RowWriter::tone_evidence_, "INSERT INTO tone_evidence VALUES (?,?,?)"},
        {&RowWriter::tone_likelihood_, "INSERT INTO tone_likelihoods VALUES (?,?,?,?)"},
        {&RowWriter::command_, "INSERT OR IGNORE INTO commands VALUES (?,?,?,?,?,?)"},
        {&RowWriter::stage_, "INSERT INTO command_stages VALUES (?,?,?,?,?,?,?,?,?)"},
        {&RowWriter::wait_, "INSERT INTO command_waits VALUES (?,?,?,?)"},
        {&RowWriter::firing_, "INSERT INTO timepoint_firings VALUES (?,?,?,?,?,?,?,?,?)"},
        {&RowWriter::explanation_, "INSERT INTO explanations VALUES (?,?,?,?,?,?,?,?,?)"},
        {&RowWriter::condition_, "INSERT INTO explanation_conditions VALUES (?,?,?,?,?,?,?)"},
        {&RowWriter::link_, "INSERT INTO link_changes VALUES (?,?,?,?,?)"},
        {&RowWriter::link_loss_, "INSERT INTO link_losses VALUES (?)"},
        {&RowWriter::alarm_, "INSERT INTO alarms VALUES (?,?,?,?,?,?,?)"},
        {&RowWriter::staleness_, "INSERT INTO staleness VALUES (?,?,?,?,?,?,?)"},
        {&RowWriter::alarm_action_, "INSERT INTO alarm_actions VALUES (?,?,?,?,?,?,?)"},
        {&RowWriter::note_, "INSERT INTO notes VALUES (?,?,?,?,?,?)"},
        {&RowWriter::search_, add_to_search_sql},
        {&RowWriter::segment_number_, "SELECT max(segment) FROM segments WHERE segment BETWEEN ?1 AND ?2"},
        {&RowWriter::segment_, "INSERT INTO segments (segment, run, packet, source, position, first_unit, last_unit,"
                               " samples, first_sclk, last_sclk, sclk) VALUES (?,?,?,?,?,?,?,?,?,?,?)"},
        {&RowWriter::block_number_,
         "SELECT max(key) / 65536 FROM pyramid_columns WHERE key BETWEEN ?1 * 65536 AND ?2 * 65536 + 65535"},
        {&RowWriter::block_, "INSERT INTO pyramid VALUES (?,?,?,?,?,?,?,?,?,?)"},
        {&RowWriter::block_column_, "INSERT INTO pyramid_columns VALUES (?,?)"},
        {&RowWriter::column_, "INSERT INTO segment_columns VALUES (?,?,?,?,?,?,?,?,?)"},
        {&RowWriter::link_number_, "SELECT number FROM words WHERE kind = 'link' AND word = ?"},
        {&RowWriter::link_word_, "INSERT INTO words SELECT 'link', max(number) + 1, ? FROM words WHERE kind = 'link'"},
        {&RowWriter::link_totals_, "INSERT OR REPLACE INTO link_totals VALUES (?,?,?,?,?,?,?,?,?,?,?)"},
        {&RowWriter::request_,
         "INSERT INTO requests SELECT ?1, coalesce(max(position), 0) + 1, ?2, ?3 FROM requests WHERE run = ?1"},
        {&RowWriter::totals_, "INSERT OR REPLACE INTO recordings VALUES (?,?,?,?,?,?,?,?,?)"},
    };
    for (const auto& [member, sql] : statements) {
        auto statement = database.prepare(sql);
        if (!statement) return statement.error();
        writer.*member = std::move(statement).value();
    }
    return writer;
}

Result<void> RowWriter::write(RunId run, const Batch& batch) {
    if (auto done = each(batch.units, [&](const auto& r) { return unit(run, r, batch); }); !done) return done;
    if (auto done = each(batch.events, [&](const auto& r) { return event(run, r); }); !done) return done;
    if (auto done = each(batch.tones, [&](const auto& r) { return tone(run, r); }); !done) return done;
    if (auto done = each(batch.stages, [&](const auto& r) { return stage(run, r); }); !done) return done;
    if (auto done = each(batch.firings, [&](const auto& r) { return firing(run, r); }); !done) return done;
    if (auto done = each(batch.explanations, [&](const auto& r) { return explanation(run, r); }); !done) return done;
    if (auto done = each(batch.links, [&](const auto& r) { return link(run, r); }); !done) return done;
    if (auto done = each(batch.alarms, [&](const auto& r) { return alarm(run, r); }); !done) return done;
    if (auto done = each(batch.staleness, [&](const auto& r) { return staleness(run, r); }); !done) return done;
    if (auto done = each(batch.alarm_actions, [&](const auto& r) { return alarm_action(run, r); }); !done) return done;
    if (auto done = each(batch.notes, [&](const auto& r) { return note(run, r); }); !done) return done;
    if (!batch.events.empty() || !batch.explanations.empty() || !batch.stages.empty() || !batch.notes.empty() ||
        !batch.alarm_actions.empty()) {
        search_.bind(1, item_key(run, batch.first_seq)).bind(2, item_key(run, batch.last_seq));
        if (auto done = search_.run(); !done) return done;
    }
    if (!batch.segments.empty()) {
        auto next = next_number(run, segment_number_);
        if (!next) return next.error();
        if (auto done = each(batch.segments, [&](const auto& r) { return segment(run, r, (*next)++); }); !done)
            return done;
    }
    if (!batch.pyramid.empty()) {
        auto next = next_number(run, block_number_);
        if (!next) return next.error();
        if (auto done = each(batch.pyramid, [&](const auto& r) { return block(run, r, (*next)++); }); !done)
            return done;
    }
    if (auto done = each(batch.requests, [&](const auto& r) { return request(run, r); }); !done) return done;
    if (auto done = each(batch.link_totals, [&](const auto& r) { return link_totals(run, r); }); !done) return done;
    if (batch.totals) return totals(run, *batch.totals);
    return {};
}

Result<std::int64_t> RowWriter::number_of_link(const std::string& name) {
    // Nearly every unit comes over one of these.
    if (name == "uhf_live") return std::int64_t{1};
    if (name == "relay") return std::int64_t{2};
    for (int attempt = 0;; ++attempt) {
        link_number_.bind(1, std::string_view(name));
        auto found = link_number_.step();
        if (!found) return found.error();
        const std::int64_t number = *found ? link_number_.integer(0) : 0;
        link_number_.reset();
        if (number > 0 || attempt > 0) return number;
        link_word_.bind(1, std::string_view(name));
        if (auto done = link_word_.run(); !done) return done.error();
    }
}

Result<void> RowWriter::unit(RunId run, const UnitRecord& record, const Batch& batch) {
    const auto link = number_of_link(record.link);
    if (!link) return link.error();
    unit_.bind(1, item_key(run, record.seq)).bind(2, std::int64_t{run.value}).bind(3, std::int64_t{record.apid.value});
    if (record.packet)
        unit_.bind(4, std::int64_t{*record.packet}).bind_null(11);
    else
        unit_.bind_null(4).bind(11, std::string_view(record.refusal));
    unit_.bind(5, record.sclk.seconds)
        .bind(6, record.ert.microseconds)
        .bind(7, *link)
        .bind(8, static_cast<std::int64_t>(record.source))
        .bind(9, static_cast<std::int64_t>(record.standing))
        .bind(10, std::int64_t{record.sampled})
        .bind_octets(12, std::span(batch.octets).subspan(record.octets.first, record.octets.count));
    return unit_.run();
}

Result<void> RowWriter::event(RunId run, const EventRecord& record) {
    event_.bind(1, item_key(run, record.seq))
        .bind(2, number(record.unit))
        .bind(3, std::int64_t{record.id.value})
        .bind(4, std::string_view(record.name))
        .bind(5, std::string_view(record.level))
        .bind(6, std::string_view(record.text))
        .bind(7, record.sclk.seconds)
        .bind(8, record.ert.microseconds)
        .bind(9, static_cast<std::int64_t>(record.source))
        .bind(10, std::int64_t{record.duplicate});
    return event_.run();
}

Result<void> RowWriter::tone(RunId run, const ToneRecord& record) {
    const auto bind_tone = [this](int parameter, const std::optional<ToneId>& tone) {
        if (tone)
            tone_.bind(parameter, std::int64_t{tone->value});
        else
            tone_.bind_null(parameter);
    };
    tone_.bind(1, item_key(run, record.seq)).bind(2, record.start.microseconds).bind(3, record.end.microseconds);
    bind_tone(4, record.tone);
    tone_.bind(5, std::string_view(record.name)).bind(6, std::string_view(record.meaning)).bind(7, record.likelihood);
    bind_tone(8, record.runner_up);
    tone_.bind(9, record.runner_up_likelihood)
        .bind(10, record.c_n0_dbhz)
        .bind(11, record.doppler_hz)
        .bind(12, std::int64_t{record.locked})
        .bind(13, std::string_view(record.model))
        .bind(14, record.sclk.seconds);
    if (auto done = tone_.run(); !done) return done;
    tone_evidence_.bind(1, item_key(run, record.seq)).bind(2, std::string_view(record.lock));
    if (record.spectrum)
        tone_evidence_.bind_octets(3, *record.spectrum);
    else
        tone_evidence_.bind_null(3);
    if (auto done = tone_evidence_.run(); !done) return done;
    for (std::size_t i = 0; i < record.best.size(); ++i) {
        tone_likelihood_.bind(1, item_key(run, record.seq))
            .bind(2, number(i))
            .bind(3, std::int64_t{record.best[i].tone})
            .bind(4, record.best[i].likelihood);
        if (auto done = tone_likelihood_.run(); !done) return done;
    }
    return {};
}

Result<void> RowWriter::stage(RunId run, const StageRecord& record) {
    if (!record.octets.empty()) {
        command_.bind(1, std::int64_t{run.value})
            .bind(2, number(record.command))
            .bind(3, std::string_view(record.name))
            .bind(4, std::string_view(record.arguments))
            .bind(5, std::int64_t{record.count})
            .bind_octets(6, record.octets);
        if (auto done = command_.run(); !done) return done;
    }
    stage_.bind(1, item_key(run, record.seq))
        .bind(2, number(record.command))
        .bind(3, std::string_view(record.name))
        .bind(4, std::string_view(record.stage))
        .bind(5, std::string_view(record.status))
        .bind(6, std::string_view(record.evidence))
        .bind(7, record.at.microseconds)
        .bind(8, std::string_view(record.arguments))
        .bind(9, std::int64_t{record.count});
    if (record.held || record.needs_approval) {
        wait_.bind(1, item_key(run, record.seq))
            .bind(2, std::int64_t{record.held})
            .bind(3, std::int64_t{record.needs_approval})
            .bind(4, std::string_view(record.asked_by));
        if (auto done = wait_.run(); !done) return done;
    }
    return stage_.run();
}

Result<void> RowWriter::firing(RunId run, const FiringRecord& record) {
    firing_.bind(1, item_key(run, record.seq))
        .bind(2, number(record.unit))
        .bind(3, std::int64_t{record.timepoint.value})
        .bind(4, std::string_view(record.name))
        .bind(5, record.triggered.seconds)
        .bind(6, record.fired.seconds)
        .bind(7, std::string_view(record.verdict))
        .bind(8, static_cast<std::int64_t>(record.source))
        .bind(9, std::int64_t{record.duplicate});
    return firing_.run();
}

Result<void> RowWriter::explanation(RunId run, const ExplanationRecord& record) {
    const auto& said = record.explanation;
    const auto key = item_key(run, record.seq);
    explanation_.bind(1, key)
        .bind(2, number(record.unit))
        .bind(3, record.sclk.seconds)
        .bind(4, std::string_view(said.decision))
        .bind(5, std::string_view(said.verdict))
        .bind(6, std::string_view(said.subject))
        .bind(7, std::string_view(said.text))
        .bind(8, static_cast<std::int64_t>(record.source))
        .bind(9, std::int64_t{record.duplicate});
    if (auto done = explanation_.run(); !done) return done;
    std::int64_t position = 0;
    for (const auto& condition : said.conditions) {
        condition_.bind(1, key).bind(2, position++).bind(3, std::string_view(condition.quantity));
        bind_number(condition_, 4, condition.value);
        condition_.bind(5, std::string_view(condition.comparison));
        bind_number(condition_, 6, condition.bound);
        condition_.bind(7, std::int64_t{condition.holds});
        if (auto done = condition_.run(); !done) return done;
    }
    return {};
}

Result<void> RowWriter::link(RunId run, const LinkRecord& record) {
    const auto number = number_of_link(record.link);
    if (!number) return number.error();
    link_.bind(1, item_key(run, record.seq))
        .bind(2, *number)
        .bind(3, std::int64_t{record.up})
        .bind(4, std::string_view(record.reason))
        .bind(5, record.ert.microseconds);
    if (auto done = link_.run(); !done || !record.lost) return done;
    link_loss_.bind(1, item_key(run, record.seq));
    return link_loss_.run();
}

Result<void> RowWriter::alarm(RunId run, const AlarmRecord& record) {
    alarm_.bind(1, item_key(run, record.seq))
        .bind(2, number(record.unit))
        .bind(3, std::int64_t{record.channel.value})
        .bind(4, std::string_view(record.severity));
    bind_number(alarm_, 5, record.value);
    alarm_.bind(6, record.sclk.seconds).bind(7, std::string_view(record.limit));
    return alarm_.run();
}

Result<void> RowWriter::staleness(RunId run, const StalenessRecord& record) {
    staleness_.bind(1, item_key(run, record.seq))
        .bind(2, std::int64_t{record.packet})
        .bind(3, std::int64_t{record.stale})
        .bind(4, record.silent_s)
        .bind(5, record.expected_s)
        .bind(6, std::string_view(record.reason))
        .bind(7, record.ert.microseconds);
    return staleness_.run();
}

Result<void> RowWriter::alarm_action(RunId run, const AlarmActionRecord& record) {
    alarm_action_.bind(1, item_key(run, record.seq))
        .bind(2, std::string_view(record.alarm))
        .bind(3, std::string_view(record.action))
        .bind(4, std::string_view(record.note))
        .bind(5, std::string_view(record.by))
        .bind(6, record.at.microseconds)
        .bind(7, record.until.microseconds);
    return alarm_action_.run();
}

Result<void> RowWriter::note(RunId run, const NoteRecord& record) {
    note_.bind(1, item_key(run, record.seq))
        .bind(2, std::string_view(record.text))
        .bind(3, std::string_view(record.by))
        .bind(4, record.at.microseconds)
        .bind(5, std::string_view(record.written));
    if (record.sclk_s)
        note_.bind(6, *record.sclk_s);
    else
        note_.bind_null(6);
    return note_.run();
}

Result<std::int64_t> RowWriter::next_number(RunId run, sqlite::Statement& largest) {
    largest.bind(1, segment_key(run, 0)).bind(2, segment_key(run, segments_max - 1));
    auto found = largest.step();
    if (!found) return found.error();
    const std::int64_t next = largest.is_null(0) ? segment_key(run, 0) : largest.integer(0) + 1;
    largest.reset();
    if (next < segment_key(run, segments_max)) return next;
    return Error{"run " + std::to_string(run.value) + " has " + std::to_string(segments_max) +
                 " segments, no more can be numbered"};
}

Result<void> RowWriter::segment(RunId run, const SegmentRecord& record, std::int64_t number_of_segment) {
    AEOLIS_CHECK(!record.sclk_s.empty() && record.values.size() == record.channels.size() * record.sclk_s.size());
    const auto [first, last] = std::ranges::minmax(record.sclk_s);
    segment_.bind(1, number_of_segment)
        .bind(2, std::int64_t{run.value})
        .bind(3, std::int64_t{record.packet})
        .bind(4, static_cast<std::int64_t>(record.source))
        .bind(5, number(record.position))
        .bind(6, number(record.first_unit))
        .bind(7, number(record.last_unit))
        .bind(8, number(record.sclk_s.size()))
        .bind(9, first)
        .bind(10, last)
        .bind_octets(11, codec_.pack(record.sclk_s));
    if (auto done = segment_.run(); !done) return done;
    for (std::size_t c = 0; c < record.channels.size(); ++c)
        if (auto done = column(column_key(number_of_segment, record.channels[c]), record, c); !done) return done;
    return {};
}

Result<void> RowWriter::block(RunId run, const PyramidRecord& record, std::int64_t number_of_block) {
    const std::size_t nodes = record.first_sclk_s.size();
    auto spans = record.first_sclk_s;
    spans.insert(spans.end(), record.last_sclk_s.begin(), record.last_sclk_s.end());
    block_.bind(1, std::int64_t{run.value})
        .bind(2, std::int64_t{record.packet})
        .bind(3, static_cast<std::int64_t>(record.source))
        .bind(4, std::int64_t{record.level})
        .bind(5, number(record.position))
        .bind(6, number_of_block)
        .bind(7, number(nodes))
        .bind(8, std::ranges::min(record.first_sclk_s))
        .bind(9, std::ranges::max(record.last_sclk_s))
        .bind_octets(10, codec_.pack(spans));
    if (auto done = block_.run(); !done) return done;
    for (std::size_t c = 0; c < record.channels.size(); ++c) {
        const auto octets = pyramid::octets_of_nodes(std::span(record.nodes).subspan(c * nodes, nodes));
        block_column_.bind(1, column_key(number_of_block, record.channels[c])).bind_octets(2, octets);
        if (auto done = block_column_.run(); !done) return done;
    }
    return {};
}

Result<void> RowWriter::column(std::int64_t key, const SegmentRecord& record, std::size_t column) {
    const std::size_t samples = record.sclk_s.size();
    const auto values = std::span(record.values).subspan(column * samples, samples);
    std::optional<std::size_t> first, last, least, largest;
    std::int64_t defined = 0;
    for (std::size_t i = 0; i < samples; ++i) {
        if (std::isnan(values[i])) continue;
        ++defined;
        if (!first) first = i;
        last = i;
        if (!least || values[i] < values[*least]) least = i;
        if (!largest || values[i] > values[*largest]) largest = i;
    }
    column_.bind(1, key).bind(2, defined);
    if (defined == 0) {
        for (int parameter = 3; parameter <= 8; ++parameter) column_.bind_null(parameter);
    } else {
        column_.bind(3, values[*least]).bind(4, record.sclk_s[*least]);
        column_.bind(5, values[*largest]).bind(6, record.sclk_s[*largest]);
        column_.bind(7, values[*first]).bind(8, values[*last]);
    }
    column_.bind_octets(9, codec_.pack(values));
    return column_.run();
}

Result<void> RowWriter::request(RunId run, const RequestRecord& record) {
    request_.bind(1, std::int64_t{run.value}).bind(2, number(record.cycle)).bind(3, std::string_view(record.request));
    return request_.run();
}

Result<void> RowWriter::totals(RunId run, const RecordingTotals& totals) {
    totals_.bind(1, std::int64_t{run.value})
        .bind(2, number(totals.recorded))
        .bind(3, number(totals.recorded_octets))
        .bind(4, number(totals.realtime))
        .bind(5, number(totals.realtime_not_recorded))
        .bind(6, number(totals.realtime_differs))
        .bind(7, number(totals.never_seen_live))
        .bind(8, number(totals.not_decoded))
        .bind(9, totals.progress);
    return totals_.run();
}

Result<void> RowWriter::link_totals(RunId run, const LinkTotals& totals) {
    const telemetry::LinkCounters& counted = totals.counters;
    link_totals_.bind(1, std::int64_t{run.value})
        .bind(2, std::string_view(totals.link))
        .bind(3, number(counted.octets))
        .bind(4, number(counted.frames))
        .bind(5, number(counted.bad_crc))
        .bind(6, number(counted.bad_header))
        .bind(7, number(counted.skipped_octets))
        .bind(8, number(counted.gaps))
        .bind(9, number(counted.missing_frames))
        .bind(10, number(counted.repeated_frames))
        .bind(11, totals.octets_per_s);
    return link_totals_.run();
}

}  // namespace aeolis::archive
