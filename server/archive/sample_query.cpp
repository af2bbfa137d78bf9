// SPDX-License-Identifier: Apache-2.0
#include "server/archive/sample_query.hpp"

#include "server/archive/packet_samples.hpp"
#include "server/archive/schema.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace aeolis::archive {

namespace {

constexpr char columns_sql[] =
    "SELECT s.segment, s.position, s.samples, s.sclk, v.value FROM segments s LEFT JOIN segment_columns v"
    " ON v.key = s.segment * 65536 + ?6 WHERE s.run = ?1 AND s.packet = ?2 AND s.source = ?3"
    " AND s.position BETWEEN ?4 AND ?5 ORDER BY s.position";
constexpr char nodes_sql[] =
    "SELECT p.position, c.nodes FROM pyramid p JOIN pyramid_columns c ON c.key = p.block * 65536 + ?5"
    " WHERE run = ?1 AND packet = ?2 AND source = ?3 AND level = ?4 AND position BETWEEN ?6 AND ?7"
    " ORDER BY position";
// Two ways to the packets after ?5, the last in a segment: through this packet's rows by the time index (the plus keeps
// SQLite on it), or through all later rows. The first suits slow packets, the second fast ones.
constexpr char tail_by_time_sql[] = "SELECT octets, sclk FROM packets WHERE run = ?1 AND apid = ?2 AND source = ?6 AND "
                                    "sclk BETWEEN ?3 AND ?4 AND +key > ?5"
                                    " AND +key <= ?8 AND packet = ?7 AND sampled = 1";
constexpr char tail_by_key_sql[] =
    "SELECT octets, sclk FROM packets WHERE key > ?5 AND key <= ?8 AND +run = ?1 AND +apid = ?2 AND +source = ?6"
    " AND sclk BETWEEN ?3 AND ?4 AND packet = ?7 AND sampled = 1";
// For another mission's packets, whose containers may have any APID.
constexpr char tail_of_unrestricted_apid_sql[] =
    "SELECT octets, sclk FROM packets WHERE key > ?5 AND key <= ?8 AND +run = ?1 AND ?2 IS NOT NULL AND +source = ?6"
    " AND sclk BETWEEN ?3 AND ?4 AND packet = ?7 AND sampled = 1";

Error damaged(const Reader::State& reader, const std::string& what, const std::string& why) {
    return {reader.database.file() + ": " + what + " is damaged: " + why +
            " (aeolis archive verify names all that is)"};
}

/// Unpacks a column of `samples` doubles.
Result<void> read_column(Reader::State& reader, const sqlite::Statement& row, int column, std::vector<double>& into) {
    const auto octets = row.octets(column);
    into.resize(static_cast<std::size_t>(row.integer(2)));
    return reader.codec.unpack(octets, into);
}

/// Appends to `into` the samples within the range among first … last - 1 of a series.
Result<void> read_samples(Reader::State& reader, const SealedSeries& series, const SampleSources& sources,
                          std::uint64_t first, std::uint64_t last, std::vector<Sample>& into) {
    auto rows = reader.query(columns_sql);
    if (!rows) return rows.error();
    auto& row = **rows;
    series.bind(row);
    row.bind(4, static_cast<std::int64_t>(first / segment_samples))
        .bind(5, static_cast<std::int64_t>((last - 1) / segment_samples))
        .bind(6, std::int64_t{sources.channel.value});
    for (;;) {
        auto found = row.step();
        if (!found) return found.error();
        if (!*found) return {};
        const auto wrong = [&](const std::string& of, const std::string& why) {
            return damaged(reader, "segment " + std::to_string(row.integer(0)) + ", " + of, why);
        };
        if (row.integer(2) < 1 || row.integer(2) > static_cast<std::int64_t>(segment_samples))
            return wrong("its number of samples", std::to_string(row.integer(2)));
        if (auto done = read_column(reader, row, 3, reader.segment_sclk_s); !done)
            return wrong("its times", done.error().message);
        if (row.is_null(4)) return wrong("channel " + std::to_string(sources.channel.value), "it is missing");
        if (auto done = read_column(reader, row, 4, reader.segment_values); !done)
            return wrong("channel " + std::to_string(sources.channel.value), done.error().message);
        const std::uint64_t base = static_cast<std::uint64_t>(row.integer(1)) * segment_samples;
        const auto from = static_cast<std::size_t>(std::max(first, base) - base);
        const std::size_t to = std::min<std::size_t>(reader.segment_values.size(), last - base);
        std::size_t end = into.size();
        into.resize(end + (to > from ? to - from : 0));
        for (std::size_t i = from; i < to; ++i)
            if (const double sclk_s = reader.segment_sclk_s[i]; sources.range.holds(sclk_s))
                into[end++] = {sclk_s, reader.segment_values[i], series.source};
        into.resize(end);
    }
}

/// Passes nodes first … last - 1 of a level to `take`.
template <typename Take>
Result<void> read_nodes(Reader::State& reader, const SealedSeries& series, ChannelId channel, unsigned level,
                        std::uint64_t first, std::uint64_t last, Take take) {
    if (first >= last) return {};
    auto rows = reader.query(nodes_sql);
    if (!rows) return rows.error();
    auto& row = **rows;
    series.bind(row);
    row.bind(4, std::int64_t{level})
        .bind(5, std::int64_t{channel.value})
        .bind(6, static_cast<std::int64_t>(first / pyramid::block_nodes))
        .bind(7, static_cast<std::int64_t>((last - 1) / pyramid::block_nodes));
    std::uint64_t next = first;
    for (;;) {
        auto found = row.step();
        if (!found) return found.error();
        if (!*found) break;
        const std::uint64_t base = static_cast<std::uint64_t>(row.integer(0)) * pyramid::block_nodes;
        const auto octets = row.octets(1);
        const std::size_t nodes = octets.size() / pyramid::node_octets;
        const std::uint64_t to = std::min(last, base + nodes);
        for (; next >= base && next < to; ++next)
            take(pyramid::node_of(octets, nodes, static_cast<std::size_t>(next - base)));
    }
    if (next == last) return {};
    return damaged(reader, "the pyramid",
                   "level " + std::to_string(level) + " of channel " + std::to_string(channel.value) +
                       " ends at node " + std::to_string(next));
}

template <typename Take>
Result<void> read_tail(Reader::State& reader, const SealedSeries& series, std::size_t column, const ClosedRange& range,
                       Take take) {
    const auto last = reader.last_seq(series.run);
    if (!last) return last.error();

    const Apid apid = reader.dictionary.packets[series.packet].apid;
    const char* const sql = apid == telemetry::OtherMission::unrestricted_apid ? tail_of_unrestricted_apid_sql
                            : series.nodes[0] < *last - series.last_packet_seq ? tail_by_time_sql
                                                                               : tail_by_key_sql;
    auto rows = reader.query(sql);
    if (!rows) return rows.error();
    (*rows)
        ->bind(1, std::int64_t{series.run.value})
        .bind(2, std::int64_t{apid.value})
        .bind(3, range.from_s)
        .bind(4, range.to_s)
        .bind(5, item_key(series.run, series.last_packet_seq))
        .bind(6, static_cast<std::int64_t>(series.source))
        .bind(7, std::int64_t{series.packet})
        .bind(8, item_key(series.run, *last));
    for (;;) {
        auto found = (*rows)->step();
        if (!found) return found.error();
        if (!*found) return {};
        if (!reader.decode((*rows)->octets(0), series.packet)) continue;
        take(Sample{(*rows)->real(1), reader.columns.value(reader.decoded, column), series.source});
    }
}

bool earlier(const Sample& a, const Sample& b) {
    return a.sclk_s < b.sclk_s;
}
bool same(const Sample& a, const Sample& b) {
    return a.sclk_s == b.sclk_s && a.value == b.value;
}

/// The samples of one packet type among those of a source, in order of SCLK and reception.
struct Stretch {
    const SealedSeries* series;
    std::size_t begin;
};

/// Orders the samples that several packet types have of a channel: at one instant by reception.
Result<void> interleave(Reader::State& reader, const SampleSources& sources, std::span<const Stretch> stretches,
                        std::vector<Sample>& samples) {
    struct Received {
        Sequence seq;
        Sample sample;
    };
    std::vector<Received> all;
    all.reserve(samples.size());
    for (std::size_t i = 0; i < stretches.size(); ++i) {
        const auto& [series, begin] = stretches[i];
        const std::size_t end = i + 1 < stretches.size() ? stretches[i + 1].begin : samples.size();
        const auto sequences = sequences_of_samples(reader, series->run, series->packet, series->source, sources.range);
        if (!sequences) return sequences.error();
        if (sequences->size() != end - begin)
            return damaged(reader, "channel " + std::to_string(sources.channel.value),
                           "it has " + std::to_string(end - begin) + " samples of " +
                               std::to_string(sequences->size()) + " packets");
        for (std::size_t at = begin; at < end; ++at) all.push_back({(*sequences)[at - begin], samples[at]});
    }
    std::ranges::sort(all, {}, [](const Received& one) { return std::pair{one.sample.sclk_s, one.seq}; });
    std::ranges::transform(all, samples.begin(), &Received::sample);
    return {};
}

/// Both sources as one series.
std::span<const Sample> merged(Reader::State& reader) {
    if (reader.realtime.empty()) return reader.recorded;
    if (reader.recorded.empty()) return reader.realtime;
    reader.both.resize(reader.realtime.size() + reader.recorded.size());
    std::merge(reader.realtime.begin(), reader.realtime.end(), reader.recorded.begin(), reader.recorded.end(),
               reader.both.begin(), earlier);
    return reader.both;
}

/// Equal intervals of a range, each with its minimum and maximum sample.
class Intervals {
  public:
    Intervals(const ClosedRange& range, std::size_t count)
        : range_(range), width_s_((range.to_s - range.from_s) / static_cast<double>(count)), intervals_(count) {}

    std::size_t index(double sclk_s) const {
        if (!(width_s_ > 0.0)) return 0;
        const auto index = static_cast<std::size_t>(std::max(0.0, (sclk_s - range_.from_s) / width_s_));
        return std::min(index, intervals_.size() - 1);
    }
    void add(const Sample& sample) {
        auto& interval = intervals_[index(sample.sclk_s)];
        if (!interval.filled || sample.value < interval.least.value) interval.least = sample;
        if (!interval.filled || sample.value > interval.largest.value) interval.largest = sample;
        interval.filled = true;
    }
    std::vector<Sample> points() const {
        std::vector<Sample> points;
        points.reserve(2 * intervals_.size());
        for (const auto& interval : intervals_) {
            if (!interval.filled) continue;
            const bool falls = earlier(interval.largest, interval.least);
            points.push_back(falls ? interval.largest : interval.least);
            if (!same(interval.least, interval.largest)) points.push_back(falls ? interval.least : interval.largest);
        }
        return points;
    }

  private:
    struct Interval {
        Sample least, largest;
        bool filled = false;
    };
    ClosedRange range_;
    double width_s_;
    std::vector<Interval> intervals_;
};

/// The coarsest level with at least half as many nodes as there are intervals.
unsigned level_for(std::size_t samples, std::size_t intervals) {
    unsigned level = pyramid::levels;
    while (level > 0 && samples / pyramid::samples_of_node(level) < (intervals + 1) / 2) --level;
    return level;
}

}  // namespace

Result<SampleSources> find_sample_sources(Reader::State& reader, const RunInfo& run, ChannelId channel,
                                          const ClosedRange& range, std::optional<Source> only) {
    SampleSources sources{channel, range, {}, 0};
    for (const auto place : reader.columns.places(channel)) {
        for (const Source source : {Source::realtime, Source::recorded}) {
            if (only && *only != source) continue;
            const auto series = sealed_series(reader, run.run, place.packet, source);
            if (!series) return series.error();
            auto found = node_ranges(reader, *series, range);
            if (!found) return found.error();
            for (const NodeRange& each : *found)
                sources.samples_at_most +=
                    static_cast<std::size_t>((each.last - each.first) * pyramid::samples_of_node(each.level));
            SampleSources::Part part{*series, std::move(found).value(), {}};
            if (!run.finished) {
                auto done = read_tail(reader, *series, place.column, range,
                                      [&](const Sample& sample) { part.tail.push_back(sample); });
                if (!done) return done.error();
            }
            sources.samples_at_most += part.tail.size();
            if (!part.node_ranges.empty() || !part.tail.empty()) sources.parts.push_back(std::move(part));
        }
    }
    return sources;
}

Result<std::span<const Sample>> exact_samples(Reader::State& reader, const SampleSources& sources) {
    reader.realtime.clear();
    reader.recorded.clear();
    std::vector<Stretch> of_realtime, of_recorded;
    for (const auto& [series, parts, tail] : sources.parts) {
        const bool realtime = series.source == Source::realtime;
        auto& into = realtime ? reader.realtime : reader.recorded;
        const std::size_t begin = into.size();
        for (std::size_t i = 0; i < parts.size();) {
            // Reads adjacent ranges of any level together, so that no segment is unpacked twice.
            const std::uint64_t first = parts[i].first * pyramid::samples_of_node(parts[i].level);
            std::uint64_t last = first;
            for (; i < parts.size() && parts[i].first * pyramid::samples_of_node(parts[i].level) == last; ++i)
                last = parts[i].last * pyramid::samples_of_node(parts[i].level);
            if (auto done = read_samples(reader, series, sources, first, last, into); !done) return done.error();
        }
        into.insert(into.end(), tail.begin(), tail.end());
        if (into.size() == begin) continue;
        (realtime ? of_realtime : of_recorded).push_back({&series, begin});
        const auto new_ones = into.begin() + static_cast<std::ptrdiff_t>(begin);  // nearly in order
        if (!std::is_sorted(new_ones, into.end(), earlier)) std::stable_sort(new_ones, into.end(), earlier);
    }
    if (of_realtime.size() > 1)
        if (auto done = interleave(reader, sources, of_realtime, reader.realtime); !done) return done.error();
    if (of_recorded.size() > 1)
        if (auto done = interleave(reader, sources, of_recorded, reader.recorded); !done) return done.error();
    return merged(reader);
}

Result<Thinned> thinned_samples(Reader::State& reader, const SampleSources& sources, std::size_t points) {
    const std::size_t count = std::max<std::size_t>(1, points / 2);
    const unsigned wanted = level_for(sources.samples_at_most, count);
    Thinned thinned;
    std::vector<Sample> found;
    found.reserve(2 * sources.samples_at_most / pyramid::samples_of_node(wanted) + segment_samples);
    const auto undefined = [](const Sample& sample) { return std::isnan(sample.value); };
    for (const auto& part : sources.parts) std::ranges::remove_copy_if(part.tail, std::back_inserter(found), undefined);
    thinned.samples = found.size();
    for (const auto& [series, parts, tail] : sources.parts) {
        for (const NodeRange& each : parts) {
            const unsigned level = std::min(wanted, each.level);
            const std::uint64_t share = pyramid::samples_of_node(each.level) / pyramid::samples_of_node(level);
            const std::uint64_t first = each.first * share, last = std::min(each.last * share, series.nodes[level]);
            if (level == 0) {
                const std::size_t before = found.size();
                if (auto done = read_samples(reader, series, sources, first, last, found); !done) return done.error();
                found.erase(std::remove_if(found.begin() + static_cast<std::ptrdiff_t>(before), found.end(), undefined),
                            found.end());
                thinned.samples += found.size() - before;
                continue;
            }
            auto done = read_nodes(reader, series, sources.channel, level, first, last, [&](const Extremes& node) {
                if (node.defined == 0) return;
                found.push_back({node.least_sclk_s, node.least, series.source});
                found.push_back({node.largest_sclk_s, node.largest, series.source});
                thinned.samples += node.defined;
            });
            if (!done) return done.error();
        }
    }
    if (found.empty()) return thinned;
    // An open end of the range is replaced by the end of the samples.
    const auto [first, last] = std::ranges::minmax_element(found, {}, &Sample::sclk_s);
    Intervals intervals({first->sclk_s, last->sclk_s}, count);
    for (const Sample& sample : found) intervals.add(sample);
    thinned.points = intervals.points();
    return thinned;
}

}  // namespace aeolis::archive
