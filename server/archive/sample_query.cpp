#include "server/archive/sample_query.hpp"

#include "server/archive/schema.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace aeolis::archive {

namespace {

constexpr char segments_sql[] =
    "SELECT segment, source, samples, first_sclk, last_sclk FROM segments"
    " WHERE run = ?1 AND packet = ?2 AND last_sclk >= ?3 AND first_sclk <= ?4 ORDER BY segment";
constexpr char count_sql[] = "SELECT coalesce(sum(samples), 0) FROM segments"
                             " WHERE run = ?1 AND packet = ?2 AND last_sclk >= ?3 AND first_sclk <= ?4";
constexpr char sealed_sql[] = "SELECT coalesce(max(last_unit), 0), coalesce(sum(samples), 0) FROM segments"
                              " WHERE run = ?1 AND packet = ?2 AND source = ?3";
constexpr char times_sql[] = "SELECT sclk FROM segments WHERE segment = ?1";
constexpr char values_sql[] = "SELECT value FROM segment_columns WHERE key = ?1";
constexpr char extremes_sql[] =
    "SELECT defined, least, least_sclk, largest, largest_sclk FROM segment_columns WHERE key = ?1";
// Two ways to the units after ?5, the last one in a segment: past all of this packet by the index (the plus keeps
// SQLite on it), or past all that came since. The first suits slow packets, the second fast ones.
constexpr char tail_by_time_sql[] =
    "SELECT octets, sclk FROM units WHERE run = ?1 AND apid = ?2 AND source = ?6 AND sclk BETWEEN ?3 AND ?4 AND +key > ?5"
    " AND +key <= ?8 AND packet = ?7 AND sampled = 1";
constexpr char tail_by_key_sql[] =
    "SELECT octets, sclk FROM units WHERE key > ?5 AND key <= ?8 AND +run = ?1 AND +apid = ?2 AND +source = ?6"
    " AND sclk BETWEEN ?3 AND ?4 AND packet = ?7 AND sampled = 1";
// Of another mission's packets, whose container may come with any APID.
constexpr char tail_of_any_apid_sql[] =
    "SELECT octets, sclk FROM units WHERE key > ?5 AND key <= ?8 AND +run = ?1 AND ?2 IS NOT NULL AND +source = ?6"
    " AND sclk BETWEEN ?3 AND ?4 AND packet = ?7 AND sampled = 1";

struct Segment {
    std::int64_t number = 0;
    Source source{};
    std::size_t samples = 0;
    ClosedRange span;
};

/// Octets of a column need not be aligned for doubles.
double number_at(std::span<const std::uint8_t> octets, std::size_t index) {
    double value;
    std::memcpy(&value, octets.data() + index * sizeof value, sizeof value);
    return value;
}

Result<std::vector<Segment>> segments_of(Reader::State& reader, RunId run, std::uint16_t packet,
                                         const ClosedRange& range) {
    auto rows = reader.query(segments_sql);
    if (!rows) return rows.error();
    (*rows)->bind(1, std::int64_t{run.value}).bind(2, std::int64_t{packet}).bind(3, range.from_s).bind(4, range.to_s);
    std::vector<Segment> segments;
    for (;;) {
        auto found = (*rows)->step();
        if (!found) return found.error();
        if (!*found) return segments;
        segments.push_back({(*rows)->integer(0),
                            static_cast<Source>((*rows)->integer(1)),
                            static_cast<std::size_t>((*rows)->integer(2)),
                            {(*rows)->real(3), (*rows)->real(4)}});
    }
}

template <typename Take>
Result<void> read_segment(Reader::State& reader, const Segment& segment, ChannelId channel, const ClosedRange& range,
                          Take take) {
    auto times = reader.query(times_sql);
    auto values = reader.query(values_sql);
    if (!times) return times.error();
    if (!values) return values.error();
    (*times)->bind(1, segment.number);
    (*values)->bind(1, column_key(segment.number, channel));
    auto found_times = (*times)->step();
    if (!found_times) return found_times.error();
    auto found_values = (*values)->step();
    if (!found_values) return found_values.error();
    const std::size_t octets = segment.samples * sizeof(double);
    if (!*found_times || !*found_values || (*times)->octets(0).size() != octets ||
        (*values)->octets(0).size() != octets)
        return Error{reader.database.file() + ": segment " + std::to_string(segment.number) + " is damaged"};
    const auto sclk = (*times)->octets(0);
    const auto value = (*values)->octets(0);
    for (std::size_t i = 0; i < segment.samples; ++i) {
        const Sample sample{number_at(sclk, i), number_at(value, i), segment.source};
        if (!std::isnan(sample.value) && range.holds(sample.sclk_s)) take(sample);
    }
    return {};
}

template <typename Take>
Result<void> read_tail(Reader::State& reader, RunId run, PacketColumns::Place place, Source source,
                       const ClosedRange& range, Take take) {
    auto sealed = reader.query(sealed_sql);
    if (!sealed) return sealed.error();
    (*sealed)->bind(1, std::int64_t{run.value}).bind(2, std::int64_t{place.packet});
    (*sealed)->bind(3, static_cast<std::int64_t>(source));
    if (auto found = (*sealed)->step(); !found) return found.error();
    const auto last_unit = static_cast<Sequence>((*sealed)->integer(0));
    const auto sealed_samples = static_cast<Sequence>((*sealed)->integer(1));
    const auto last = reader.last_seq(run);
    if (!last) return last.error();

    const Apid apid = reader.dictionary.packets[place.packet].apid;
    const char* const sql = apid == telemetry::OtherMission::any_apid      ? tail_of_any_apid_sql
                            : sealed_samples < *last - last_unit ? tail_by_time_sql
                                                                 : tail_by_key_sql;
    auto rows = reader.query(sql);
    if (!rows) return rows.error();
    (*rows)
        ->bind(1, std::int64_t{run.value})
        .bind(2, std::int64_t{apid.value})
        .bind(3, range.from_s)
        .bind(4, range.to_s)
        .bind(5, item_key(run, last_unit))
        .bind(6, static_cast<std::int64_t>(source))
        .bind(7, std::int64_t{place.packet})
        .bind(8, item_key(run, *last));
    for (;;) {
        auto found = (*rows)->step();
        if (!found) return found.error();
        if (!*found) return {};
        if (!reader.decode((*rows)->octets(0))) continue;
        const double value = reader.columns.value(reader.decoded, place.column);
        if (!std::isnan(value)) take(Sample{(*rows)->real(1), value, source});
    }
}

template <typename Take>
Result<void> read_tails(Reader::State& reader, const RunInfo& run, ChannelId channel, const ClosedRange& range,
                        Take take) {
    if (run.finished) return {};
    for (const auto place : reader.columns.places(channel))
        for (const Source source : {Source::realtime, Source::recorded})
            if (auto done = read_tail(reader, run.run, place, source, range, take); !done) return done;
    return {};
}

bool earlier(const Sample& a, const Sample& b) {
    return a.sclk_s < b.sclk_s;
}

/// Each source comes nearly in order; together they interleave.
std::vector<Sample> merged(std::vector<Sample> realtime, std::vector<Sample> recorded) {
    for (auto* samples : {&realtime, &recorded})
        if (!std::is_sorted(samples->begin(), samples->end(), earlier))
            std::sort(samples->begin(), samples->end(), earlier);
    if (realtime.empty()) return recorded;
    if (recorded.empty()) return realtime;
    std::vector<Sample> all(realtime.size() + recorded.size());
    std::merge(realtime.begin(), realtime.end(), recorded.begin(), recorded.end(), all.begin(), earlier);
    return all;
}

/// Equal intervals of a range, each with its least and its largest sample.
class Intervals {
  public:
    Intervals(const ClosedRange& range, std::size_t count)
        : range_(range), width_s_((range.to_s - range.from_s) / static_cast<double>(count)), intervals_(count) {}

    std::size_t index(double sclk_s) const {
        if (!(width_s_ > 0.0)) return 0;
        const auto index = static_cast<std::size_t>(std::max(0.0, (sclk_s - range_.from_s) / width_s_));
        return std::min(index, intervals_.size() - 1);
    }
    void add(const Sample& sample) { add(sample, sample, 1); }
    void add(const Sample& least, const Sample& largest, std::uint64_t count) {
        auto& interval = intervals_[index(least.sclk_s)];
        if (interval.count == 0 || least.value < interval.least.value) interval.least = least;
        if (interval.count == 0 || largest.value > interval.largest.value) interval.largest = largest;
        interval.count += count;
    }
    Thinned result() const {
        Thinned thinned;
        thinned.points.reserve(2 * intervals_.size());
        for (const auto& interval : intervals_) {
            if (interval.count == 0) continue;
            thinned.samples += interval.count;
            const bool falls = earlier(interval.largest, interval.least);
            thinned.points.push_back(falls ? interval.largest : interval.least);
            if (interval.least.sclk_s != interval.largest.sclk_s)
                thinned.points.push_back(falls ? interval.least : interval.largest);
        }
        return thinned;
    }

  private:
    struct Interval {
        Sample least, largest;
        std::uint64_t count = 0;
    };
    ClosedRange range_;
    double width_s_;
    std::vector<Interval> intervals_;
};

/// False: the segment has to be read.
Result<bool> add_extremes(Reader::State& reader, const Segment& segment, ChannelId channel, const ClosedRange& range,
                          Intervals& intervals) {
    if (!range.holds(segment.span.from_s) || !range.holds(segment.span.to_s)) return false;
    if (intervals.index(segment.span.from_s) != intervals.index(segment.span.to_s)) return false;
    auto rows = reader.query(extremes_sql);
    if (!rows) return rows.error();
    auto& row = **rows;
    row.bind(1, column_key(segment.number, channel));
    auto found = row.step();
    if (!found) return found.error();
    if (!*found) return false;
    if (const auto defined = static_cast<std::uint64_t>(row.integer(0)); defined > 0)
        intervals.add({row.real(2), row.real(1), segment.source}, {row.real(4), row.real(3), segment.source}, defined);
    return true;
}

} // namespace

Result<std::size_t> samples_at_most(Reader::State& reader, const RunInfo& run, ChannelId channel,
                                    const ClosedRange& range) {
    std::size_t samples = 0;
    for (const auto place : reader.columns.places(channel)) {
        auto rows = reader.query(count_sql);
        if (!rows) return rows.error();
        auto& row = **rows;
        row.bind(1, std::int64_t{run.run.value}).bind(2, std::int64_t{place.packet});
        row.bind(3, range.from_s).bind(4, range.to_s);
        if (auto found = row.step(); !found) return found.error();
        samples += static_cast<std::size_t>(row.integer(0));
    }
    auto tails = read_tails(reader, run, channel, range, [&](const Sample&) { ++samples; });
    if (!tails) return tails.error();
    return samples;
}

Result<std::vector<Sample>> exact_samples(Reader::State& reader, const RunInfo& run, ChannelId channel,
                                          const ClosedRange& range) {
    std::vector<Sample> realtime, recorded;
    const auto take = [&](const Sample& sample) {
        (sample.source == Source::realtime ? realtime : recorded).push_back(sample);
    };
    for (const auto place : reader.columns.places(channel)) {
        const auto segments = segments_of(reader, run.run, place.packet, range);
        if (!segments) return segments.error();
        for (const auto& segment : *segments)
            if (auto done = read_segment(reader, segment, channel, range, take); !done) return done.error();
    }
    if (auto done = read_tails(reader, run, channel, range, take); !done) return done.error();
    return merged(std::move(realtime), std::move(recorded));
}

Result<Thinned> thinned_samples(Reader::State& reader, const RunInfo& run, ChannelId channel, const ClosedRange& range,
                                std::size_t points) {
    std::vector<Sample> tail;
    if (auto done = read_tails(reader, run, channel, range, [&](const Sample& sample) { tail.push_back(sample); });
        !done)
        return done.error();
    std::vector<Segment> all;
    for (const auto place : reader.columns.places(channel)) {
        auto segments = segments_of(reader, run.run, place.packet, range);
        if (!segments) return segments.error();
        all.insert(all.end(), segments->begin(), segments->end());
    }
    // An open end of the range is where the samples end.
    ClosedRange filled{range.to_s, range.from_s};
    for (const auto& segment : all) {
        filled.from_s = std::min(filled.from_s, segment.span.from_s);
        filled.to_s = std::max(filled.to_s, segment.span.to_s);
    }
    for (const auto& sample : tail) {
        filled.from_s = std::min(filled.from_s, sample.sclk_s);
        filled.to_s = std::max(filled.to_s, sample.sclk_s);
    }
    filled.from_s = std::max(filled.from_s, range.from_s);
    filled.to_s = std::min(filled.to_s, range.to_s);
    Intervals intervals(filled, std::max<std::size_t>(1, points / 2));
    for (const auto& segment : all) {
        const auto known = add_extremes(reader, segment, channel, range, intervals);
        if (!known) return known.error();
        if (*known) continue;
        auto done = read_segment(reader, segment, channel, range, [&](const Sample& sample) { intervals.add(sample); });
        if (!done) return done.error();
    }
    for (const auto& sample : tail)
        intervals.add(sample);
    return intervals.result();
}

} // namespace aeolis::archive
