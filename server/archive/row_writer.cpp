// SPDX-License-Identifier: Apache-2.0
#include "server/archive/row_writer.hpp"
#include "server/archive/link_total_columns.hpp"

#include "server/archive/item_rows.hpp"
#include "server/archive/pyramid.hpp"
#include "server/archive/schema.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::archive {

namespace {

template <typename Records, typename Write>
Result<void> each(const Records& records, Write write) {
    for (const auto& record : records)
        if (auto done = write(record); !done) return done;
    return {};
}

std::string insert_sql(const char* table, std::size_t columns) {
    std::string sql = std::string("INSERT INTO ") + table + " VALUES (?";
    for (std::size_t i = 1; i < columns; ++i) sql += ",?";
    return sql + ")";
}

}  // namespace

Result<RowWriter> RowWriter::open(sqlite::Database& database) {
    RowWriter writer;
    const auto prepare = [&](sqlite::Statement& statement, const std::string& sql) -> Result<void> {
        auto prepared = database.prepare(sql.c_str());
        if (!prepared) return prepared.error();
        statement = std::move(prepared).value();
        return {};
    };
    const auto items = try_item_kinds([&]<typename Record>(ItemKind<Record>) {
        auto& [row, part] = std::get<ItemStatements<Record>>(writer.items_);
        auto done = prepare(row, insert_sql(ItemTable<Record>::name, 2 + columns_of<ItemTable, Record>().size()));
        if constexpr (HasParts<Record>)
            if (done)
                done = prepare(part, insert_sql(PartTable<PartOf<Record>>::name,
                                                2 + columns_of<PartTable, PartOf<Record>>().size()));
        return done;
    });
    if (!items) return items.error();
    const std::string put_totals = put_link_totals_sql();
    const std::pair<sqlite::Statement RowWriter::*, const char*> statements[] = {
        {&RowWriter::search_, add_to_search_sql},
        {&RowWriter::segment_number_, "SELECT max(segment) FROM segments WHERE segment BETWEEN ?1 AND ?2"},
        {&RowWriter::segment_,
         "INSERT INTO segments (segment, run, packet, source, position, first_packet, last_packet,"
         " samples, first_sclk, last_sclk, sclk) VALUES (?,?,?,?,?,?,?,?,?,?,?)"},
        {&RowWriter::block_number_,
         "SELECT max(key) / 65536 FROM pyramid_columns WHERE key BETWEEN ?1 * 65536 AND ?2 * 65536 + 65535"},
        {&RowWriter::block_, "INSERT INTO pyramid VALUES (?,?,?,?,?,?,?,?,?,?)"},
        {&RowWriter::block_column_, "INSERT INTO pyramid_columns VALUES (?,?)"},
        {&RowWriter::column_, "INSERT INTO segment_columns VALUES (?,?,?,?,?,?,?,?,?)"},
        {&RowWriter::link_number_, "SELECT number FROM words WHERE kind = 'link' AND word = ?"},
        {&RowWriter::link_word_, "INSERT INTO words SELECT 'link', max(number) + 1, ? FROM words WHERE kind = 'link'"},
        {&RowWriter::link_totals_, put_totals.c_str()},
        {&RowWriter::sequence_totals_, "INSERT OR REPLACE INTO sequence_totals VALUES (?,?,?,?,?,?,?,?,?,?,?)"},
        {&RowWriter::raw_, "INSERT OR IGNORE INTO raw_octets VALUES (?,?,?,?,?)"},
        {&RowWriter::raw_kind_, "INSERT INTO words VALUES ('octets of ' || ?1, ?2, ?3) ON CONFLICT DO UPDATE SET"
                                " word = excluded.word WHERE word <> excluded.word AND excluded.word = 'datagrams'"},
        {&RowWriter::raw_removed_, "DELETE FROM raw_octets WHERE run = ?1 AND link = ?2 AND first < ?3"
                                   " AND first + length(octets) <= ?3"},
        {&RowWriter::request_,
         "INSERT INTO requests SELECT ?1, coalesce(max(position), 0) + 1, ?2, ?3 FROM requests WHERE run = ?1"},
        {&RowWriter::totals_, "INSERT OR REPLACE INTO recordings VALUES (?,?,?,?,?,?,?,?,?)"},
    };
    for (const auto& [member, sql] : statements)
        if (auto done = prepare(writer.*member, sql); !done) return done.error();
    return writer;
}

Result<void> RowWriter::write(RunId run, const Batch& batch) {
    bool to_search = false;
    const auto items = try_item_kinds([&]<typename Record>(ItemKind<Record>) {
        const auto& records = batch.*ItemTable<Record>::of_batch;
        to_search = to_search || (!records.empty() && is_searched<Record>());
        return each(records, [&](const Record& record) { return item(run, record, batch); });
    });
    if (!items) return items;
    if (to_search) {
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
    if (auto done = each(batch.raw, [&](const auto& r) { return raw(run, r, batch.raw_kept); }); !done) return done;
    if (batch.totals) return totals(run, *batch.totals);
    return {};
}

Result<std::int64_t> RowWriter::number_of_link(const std::string& name) {
    // Nearly every packet came over one of these two links. The schema numbers them, so they need no query.
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

template <typename Record>
Result<void> RowWriter::item(RunId run, const Record& record, const Batch& batch) {
    auto& [row, part] = std::get<ItemStatements<Record>>(items_);
    const auto key = item_key(run, record.seq);
    BindColumns bind{row.bind(1, key).bind(2, record.ert.microseconds), 3, run, batch.octets};
    if constexpr (requires { record.link; }) {
        const auto link = number_of_link(record.link);
        if (!link) return link.error();
        bind.link = *link;
    }
    ItemTable<Record>::columns(record, bind);
    if (auto done = row.run(); !done) return done;
    if constexpr (HasParts<Record>) {
        std::int64_t position = 0;
        for (const auto& each : ItemTable<Record>::parts(record)) {
            PartTable<PartOf<Record>>::columns(each, BindColumns{part.bind(1, key).bind(2, position++), 3});
            if (auto done = part.run(); !done) return done;
        }
    }
    return {};
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
        .bind(5, sqlite::number(record.position))
        .bind(6, sqlite::number(record.first_packet_seq))
        .bind(7, sqlite::number(record.last_packet_seq))
        .bind(8, sqlite::number(record.sclk_s.size()))
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
        .bind(5, sqlite::number(record.position))
        .bind(6, number_of_block)
        .bind(7, sqlite::number(nodes))
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
    request_.bind(1, std::int64_t{run.value})
        .bind(2, sqlite::number(record.cycle))
        .bind(3, std::string_view(record.request));
    return request_.run();
}

Result<void> RowWriter::totals(RunId run, const RecordingTotals& totals) {
    totals_.bind(1, std::int64_t{run.value})
        .bind(2, sqlite::number(totals.recorded))
        .bind(3, sqlite::number(totals.recorded_octets))
        .bind(4, sqlite::number(totals.realtime))
        .bind(5, sqlite::number(totals.realtime_not_recorded))
        .bind(6, sqlite::number(totals.realtime_differs))
        .bind(7, sqlite::number(totals.never_seen_live))
        .bind(8, sqlite::number(totals.not_decoded))
        .bind(9, totals.progress);
    return totals_.run();
}

Result<void> RowWriter::link_totals(RunId run, const LinkTotals& totals) {
    link_totals_.bind(1, std::int64_t{run.value}).bind(2, std::string_view(totals.link)).bind(3, totals.octets_per_s);
    int parameter = 4;
    for (const auto& column : link_total_columns()) link_totals_.bind(parameter++, sqlite::number(column.of(totals)));
    if (auto done = link_totals_.run(); !done) return done;
    for (const auto& sequence : totals.sequences)
        if (auto done = sequence_totals(run, totals.link, sequence); !done) return done;
    return {};
}

/// Adds a piece, and removes those of its link that end before the last `kept` octets.
Result<void> RowWriter::raw(RunId run, const RawRecord& record, std::uint64_t kept) {
    raw_.bind(1, std::int64_t{run.value})
        .bind(2, std::string_view(record.link))
        .bind(3, sqlite::number(record.first))
        .bind(4, record.ert.microseconds)
        .bind_octets(5, record.octets);
    if (auto done = raw_.run(); !done) return done;
    raw_kind_.bind(1, std::string_view(record.link))
        .bind(2, std::int64_t{run.value})
        .bind(3, std::string_view(record.datagram ? "datagrams" : "stream"));
    if (auto done = raw_kind_.run(); !done) return done;
    const std::uint64_t end = record.first + record.octets.size();
    if (end <= kept) return {};
    raw_removed_.bind(1, std::int64_t{run.value})
        .bind(2, std::string_view(record.link))
        .bind(3, sqlite::number(end - kept));
    return raw_removed_.run();
}

Result<void> RowWriter::sequence_totals(RunId run, const std::string& link, const telemetry::SequenceTotals& totals) {
    const telemetry::SequenceCounters& counted = totals.counters;
    sequence_totals_.bind(1, std::int64_t{run.value})
        .bind(2, std::string_view(link))
        .bind(3, std::int64_t{totals.packets})
        .bind(4, std::string_view(totals.name))
        .bind(5, sqlite::number(counted.received))
        .bind(6, sqlite::number(counted.gaps))
        .bind(7, sqlite::number(counted.missing))
        .bind(8, sqlite::number(counted.repeated))
        .bind(9, sqlite::number(counted.late))
        .bind(10, sqlite::number(counted.restarts))
        .bind(11, sqlite::number(counted.wraps));
    return sequence_totals_.run();
}

}  // namespace aeolis::archive
