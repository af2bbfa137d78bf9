// SPDX-License-Identifier: Apache-2.0
#include "server/archive/packet_samples.hpp"

#include "server/archive/sample_walk.hpp"
#include "server/archive/schema.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

namespace aeolis::archive {
namespace {

// ?1 run, ?2 APID, ?3 source, ?4 packet, ?5 … ?6 SCLK; octets, sclk, ert_us, key of sampled packets.
constexpr char newest_by_time_sql[] =
    "SELECT octets, sclk, ert_us, key FROM packets WHERE run = ?1 AND apid = ?2 AND source = ?3 AND packet = ?4"
    " AND sclk BETWEEN ?5 AND ?6 AND sampled = 1 ORDER BY sclk DESC, key DESC LIMIT 1";
// By reception, among the keys ?7 … ?8: through all of these rows, or (the plus) through those of the APID by the time
// index. The first suits fast packets, the second slow ones.
constexpr char newest_by_key_sql[] =
    "SELECT octets, sclk, ert_us, key FROM packets WHERE key BETWEEN ?7 AND ?8 AND +run = ?1 AND ?2 IS NOT NULL"
    " AND +source = ?3 AND packet = ?4 AND sclk BETWEEN ?5 AND ?6 AND sampled = 1 ORDER BY key DESC LIMIT 1";
constexpr char newest_of_apid_sql[] =
    "SELECT octets, sclk, ert_us, key FROM packets WHERE run = ?1 AND apid = ?2 AND source = ?3 AND packet = ?4"
    " AND sclk BETWEEN ?5 AND ?6 AND +key BETWEEN ?7 AND ?8 AND sampled = 1 ORDER BY key DESC LIMIT 1";
constexpr char last_segment_by_sql[] =
    "SELECT first_packet, last_packet FROM segments WHERE run = ?1 AND packet = ?2 AND source = ?3 AND first_sclk <= ?4"
    " ORDER BY position DESC LIMIT 1";
constexpr char in_range_sql[] =
    "SELECT octets, sclk, ert_us, key FROM packets WHERE run = ?1 AND apid = ?2 AND source = ?3 AND packet = ?4"
    " AND sclk BETWEEN ?5 AND ?6 AND sampled = 1 ORDER BY sclk, key";
constexpr char in_range_of_unrestricted_apid_sql[] =
    "SELECT octets, sclk, ert_us, key FROM packets WHERE run = ?1 AND ?2 IS NOT NULL AND source = ?3 AND packet = ?4"
    " AND sclk BETWEEN ?5 AND ?6 AND sampled = 1 ORDER BY sclk, key";

struct PacketsOf {
    RunId run;
    std::size_t packet = 0;
    Apid apid;
    Source source{};

    bool unrestricted_apid() const { return apid == telemetry::OtherMission::unrestricted_apid; }
    void bind(sqlite::Statement& row, const ClosedRange& range) const {
        row.bind(1, std::int64_t{run.value})
            .bind(2, std::int64_t{apid.value})
            .bind(3, static_cast<std::int64_t>(source))
            .bind(4, static_cast<std::int64_t>(packet))
            .bind(5, range.from_s)
            .bind(6, range.to_s);
    }
};

/// The newest packet by reception among the keys first … last, as a row to read; none: there is none.
Result<std::optional<Query>> newest_among(Reader::State& reader, const PacketsOf& of, double to_s, std::int64_t first,
                                          std::int64_t last, bool by_key) {
    auto rows = reader.query(by_key || of.unrestricted_apid() ? newest_by_key_sql : newest_of_apid_sql);
    if (!rows) return rows.error();
    of.bind(**rows, {-std::numeric_limits<double>::infinity(), to_s});
    (*rows)->bind(7, first).bind(8, last);
    auto found = (*rows)->step();
    if (!found) return found.error();
    if (!*found) return std::optional<Query>{};
    return std::optional{std::move(*rows)};
}

/// In no segment yet, or in the last segment that begins early enough.
Result<std::optional<Query>> newest_by_reception(Reader::State& reader, const RunInfo& run, const PacketsOf& of,
                                                 double to_s) {
    const auto series = sealed_series(reader, run.run, static_cast<std::uint16_t>(of.packet), of.source);
    if (!series) return series.error();
    const auto last = reader.last_seq(run.run);
    if (!last) return last.error();
    if (!run.finished) {
        const bool fast = series->nodes[0] >= *last - series->last_packet_seq;
        auto tail = newest_among(reader, of, to_s, item_key(run.run, series->last_packet_seq + 1),
                                 item_key(run.run, *last), fast);
        if (!tail || *tail) return tail;
    }
    auto segment = reader.query(last_segment_by_sql);
    if (!segment) return segment.error();
    (*segment)
        ->bind(1, std::int64_t{run.run.value})
        .bind(2, static_cast<std::int64_t>(of.packet))
        .bind(3, static_cast<std::int64_t>(of.source))
        .bind(4, to_s);
    auto found = (*segment)->step();
    if (!found) return found.error();
    if (!*found) return std::optional<Query>{};
    return newest_among(reader, of, to_s, item_key(run.run, static_cast<Sequence>((*segment)->integer(0))),
                        item_key(run.run, static_cast<Sequence>((*segment)->integer(1))), true);
}

Result<std::optional<Query>> newest_by_clock(Reader::State& reader, const PacketsOf& of, double to_s) {
    auto rows = reader.query(newest_by_time_sql);
    if (!rows) return rows.error();
    of.bind(**rows, {-std::numeric_limits<double>::infinity(), to_s});
    auto found = (*rows)->step();
    if (!found) return found.error();
    if (!*found) return std::optional<Query>{};
    return std::optional{std::move(*rows)};
}

/// The sample of a column of the packet just decoded.
ChannelValue sample_of(Reader::State& reader, const sqlite::Statement& row, Source source, ChannelId channel,
                       std::size_t column) {
    ChannelValue value{channel, reader.columns.value(reader.decoded, column), Sclk{row.real(1)}, source};
    value.seq = sequence_of(row.integer(3));
    value.ert = Ert{row.integer(2)};
    value.sclk_by_reception = !reader.decoded.timed;
    if (needs_text(reader.dictionary.channels[channel.value].type))
        for (auto& [of, text] : reader.columns.texts(reader.decoded))
            if (of == column) value.text = std::move(text);
    return value;
}

/// In our mission by the clock, and at one instant of one source by reception; in another mission by reception.
bool is_newer(const ChannelValue& value, const ChannelValue& known, bool by_reception) {
    if (by_reception) return known.seq < value.seq;
    if (known.sclk == value.sclk) return known.source == value.source && known.seq < value.seq;
    return known.sclk < value.sclk;
}

}  // namespace

Result<void> note_newest(Reader::State& reader, const RunInfo& run, std::size_t packet, Source source, double to_s,
                         Newest& newest) {
    const auto& channels = reader.columns.channels(packet);
    if (channels.empty()) return {};
    const PacketsOf of{run.run, packet, reader.dictionary.packets[packet].apid, source};
    auto found =
        reader.other != nullptr ? newest_by_reception(reader, run, of, to_s) : newest_by_clock(reader, of, to_s);
    if (!found) return found.error();
    if (!*found || !reader.decode((**found)->octets(0), packet)) return {};
    for (std::size_t i = 0; i < channels.size(); ++i) {
        auto& known = newest[channels[i].value];
        auto value = sample_of(reader, ***found, source, channels[i], i);
        if (!known || is_newer(value, *known, reader.other != nullptr)) known = std::move(value);
    }
    return {};
}

Result<std::vector<ChannelValue>> text_samples(Reader::State& reader, const RunInfo& run, ChannelId channel,
                                               const ClosedRange& range, std::optional<Source> only) {
    std::vector<ChannelValue> samples;
    for (const auto place : reader.columns.places(channel)) {
        for (const Source source : {Source::realtime, Source::recorded}) {
            if (only && *only != source) continue;
            const PacketsOf of{run.run, place.packet, reader.dictionary.packets[place.packet].apid, source};
            auto rows = reader.query(of.unrestricted_apid() ? in_range_of_unrestricted_apid_sql : in_range_sql);
            if (!rows) return rows.error();
            of.bind(**rows, range);
            for (;;) {
                auto found = (*rows)->step();
                if (!found) return found.error();
                if (!*found) break;
                if (!reader.decode((*rows)->octets(0), place.packet)) continue;
                if (samples.size() == exact_samples_max)
                    return Error{"the range holds more than " + std::to_string(exact_samples_max) + " samples of '" +
                                 reader.dictionary.channels[channel.value].name + "': ask for less"};
                samples.push_back(sample_of(reader, **rows, source, channel, place.column));
            }
        }
    }
    std::ranges::sort(samples, {}, [](const ChannelValue& sample) {
        return std::tuple{sample.sclk.seconds, sample.source, sample.seq};
    });
    return samples;
}

Result<std::vector<Sequence>> sequences_of_samples(Reader::State& reader, RunId run, std::size_t packet, Source source,
                                                   const ClosedRange& range) {
    const PacketsOf of{run, packet, reader.dictionary.packets[packet].apid, source};
    auto rows = reader.query(of.unrestricted_apid() ? in_range_of_unrestricted_apid_sql : in_range_sql);
    if (!rows) return rows.error();
    of.bind(**rows, range);
    std::vector<Sequence> sequences;
    for (;;) {
        auto found = (*rows)->step();
        if (!found) return found.error();
        if (!*found) return sequences;
        sequences.push_back(sequence_of((*rows)->integer(3)));
    }
}

}  // namespace aeolis::archive
