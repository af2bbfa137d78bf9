// SPDX-License-Identifier: Apache-2.0
#include "server/archive/sample_walk.hpp"

#include <algorithm>

namespace aeolis::archive {

namespace {

constexpr char last_segment_sql[] = "SELECT position, samples, last_packet FROM segments"
                                    " WHERE run = ?1 AND packet = ?2 AND source = ?3 ORDER BY position DESC LIMIT 1";
constexpr char last_block_sql[] = "SELECT position, nodes FROM pyramid WHERE run = ?1 AND packet = ?2 AND source = ?3"
                                  " AND level = ?4 ORDER BY position DESC LIMIT 1";
constexpr char blocks_sql[] = "SELECT position, nodes, first_sclk, last_sclk, spans FROM pyramid WHERE run = ?1"
                              " AND packet = ?2 AND source = ?3 AND level = ?4 AND position BETWEEN ?5 AND ?6";
constexpr char segments_sql[] = "SELECT position, samples FROM segments WHERE run = ?1 AND packet = ?2 AND source = ?3"
                                " AND position >= ?4 AND last_sclk >= ?5 AND first_sclk <= ?6 ORDER BY position";

std::uint64_t count(const sqlite::Statement& row, int column) {
    return static_cast<std::uint64_t>(row.integer(column));
}
class Walk {
  public:
    Walk(Reader::State& reader, const SealedSeries& series, const ClosedRange& range)
        : reader_(reader), series_(series), range_(range) {}

    /// Visits nodes first … last - 1 of a level; level 0: samples.
    Result<void> visit(unsigned level, std::uint64_t first, std::uint64_t last) {
        if (first >= last) return {};
        if (level == 0) {
            take(0, first, last);
            return {};
        }
        std::vector<std::uint64_t> cut;  // nodes across an end of the range, for the level below
        if (auto done = visit_blocks(level, first, last, cut); !done) return done;
        const std::uint64_t shares = level == 1 ? pyramid::node_samples : pyramid::fan_out;
        for (const std::uint64_t node : cut)
            if (auto done = visit(level - 1, node * shares, std::min((node + 1) * shares, series_.nodes[level - 1]));
                !done)
                return done;
        return {};
    }

    /// Visits the segments that no block covers yet.
    Result<void> visit_segments(std::uint64_t from_sample) {
        auto rows = reader_.query(segments_sql);
        if (!rows) return rows.error();
        series_.bind(**rows);
        (*rows)
            ->bind(4, static_cast<std::int64_t>(from_sample / segment_samples))
            .bind(5, range_.from_s)
            .bind(6, range_.to_s);
        for (;;) {
            auto found = (*rows)->step();
            if (!found) return found.error();
            if (!*found) return {};
            const std::uint64_t first = count(**rows, 0) * segment_samples;
            take(0, first, first + count(**rows, 1));
        }
    }

    std::vector<NodeRange> result() && {
        const auto first_sample = [](const NodeRange& each) {
            return each.first * pyramid::samples_of_node(each.level);
        };
        std::ranges::sort(node_ranges_, {}, first_sample);
        std::vector<NodeRange> joined;
        for (const NodeRange& each : node_ranges_) {
            if (!joined.empty() && joined.back().level == each.level && joined.back().last == each.first)
                joined.back().last = each.last;
            else
                joined.push_back(each);
        }
        return joined;
    }

  private:
    void take(unsigned level, std::uint64_t first, std::uint64_t last) { node_ranges_.push_back({level, first, last}); }

    Result<void> visit_blocks(unsigned level, std::uint64_t first, std::uint64_t last,
                              std::vector<std::uint64_t>& cut) {
        auto rows = reader_.query(blocks_sql);
        if (!rows) return rows.error();
        series_.bind(**rows);
        (*rows)
            ->bind(4, std::int64_t{level})
            .bind(5, static_cast<std::int64_t>(first / pyramid::block_nodes))
            .bind(6, static_cast<std::int64_t>((last - 1) / pyramid::block_nodes));
        for (;;) {
            auto found = (*rows)->step();
            if (!found) return found.error();
            if (!*found) return {};
            const auto& row = **rows;
            const std::uint64_t base = count(row, 0) * pyramid::block_nodes,
                                nodes = std::min(count(row, 1), pyramid::block_nodes);
            const std::uint64_t from = std::max(first, base), to = std::min(last, base + nodes);
            if (row.real(2) > range_.to_s || row.real(3) < range_.from_s) continue;
            if (range_.holds(row.real(2)) && range_.holds(row.real(3))) {
                take(level, from, to);
                continue;
            }
            spans_s_.resize(static_cast<std::size_t>(2 * nodes));
            if (auto done = reader_.codec.unpack(row.octets(4), spans_s_); !done)
                return Error{reader_.database.file() + ": block " + std::to_string(row.integer(0)) + " of level " +
                             std::to_string(level) + " of the pyramid is damaged: " + done.error().message +
                             " (aeolis archive verify names all that is)"};
            for (std::uint64_t node = from; node < to; ++node) {
                const double from_s = spans_s_[node - base], to_s = spans_s_[nodes + node - base];
                if (from_s > range_.to_s || to_s < range_.from_s) continue;
                if (range_.holds(from_s) && range_.holds(to_s))
                    take(level, node, node + 1);
                else
                    cut.push_back(node);
            }
        }
    }

    Reader::State& reader_;
    const SealedSeries& series_;
    const ClosedRange& range_;
    std::vector<NodeRange> node_ranges_;
    std::vector<double> spans_s_;
};

}  // namespace

void SealedSeries::bind(sqlite::Statement& statement) const {
    statement.bind(1, std::int64_t{run.value}).bind(2, std::int64_t{packet}).bind(3, static_cast<std::int64_t>(source));
}

Result<SealedSeries> sealed_series(Reader::State& reader, RunId run, std::uint16_t packet, Source source) {
    SealedSeries series;
    series.run = run;
    series.packet = packet;
    series.source = source;
    auto segment = reader.query(last_segment_sql);
    if (!segment) return segment.error();
    series.bind(**segment);
    auto found = (*segment)->step();
    if (!found) return found.error();
    if (!*found) return series;
    series.nodes[0] = count(**segment, 0) * segment_samples + count(**segment, 1);
    series.last_packet_seq = count(**segment, 2);
    for (unsigned level = 1; level <= pyramid::levels; ++level) {
        auto block = reader.query(last_block_sql);
        if (!block) return block.error();
        series.bind(**block);
        (*block)->bind(4, std::int64_t{level});
        found = (*block)->step();
        if (!found) return found.error();
        if (!*found) break;
        series.nodes[level] = count(**block, 0) * pyramid::block_nodes + count(**block, 1);
    }
    return series;
}

Result<std::vector<NodeRange>> node_ranges(Reader::State& reader, const SealedSeries& series,
                                           const ClosedRange& range) {
    if (series.nodes[0] == 0) return std::vector<NodeRange>{};
    Walk walk(reader, series, range);
    std::uint64_t reached = 0;  // in samples
    for (unsigned level = pyramid::levels; level >= 1; --level) {
        const std::uint64_t size = pyramid::samples_of_node(level);
        if (auto done = walk.visit(level, (reached + size - 1) / size, series.nodes[level]); !done) return done.error();
        reached = std::max(reached, std::min(series.nodes[level] * size, series.nodes[0]));
    }
    if (reached < series.nodes[0])
        if (auto done = walk.visit_segments(reached); !done) return done.error();
    return std::move(walk).result();
}

}  // namespace aeolis::archive
