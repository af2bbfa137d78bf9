// SPDX-License-Identifier: Apache-2.0
#include "server/archive/item_rows.hpp"
#include "server/archive/link_total_columns.hpp"
#include "server/archive/path_comparison.hpp"
#include "server/archive/reader.hpp"
#include "server/archive/reader_state.hpp"
#include "server/archive/schema.hpp"
#include "telemetry/port.hpp"
#include "telemetry/text.hpp"

#include <algorithm>
#include <cmath>
#include <map>

// Compares live packets and tones with the recording.
namespace aeolis::archive {

const char* name_of(PathComparison found, Source source, bool recording_complete) {
    switch (found) {
    case PathComparison::identical: return "identical";
    case PathComparison::differs: return "differs";
    case PathComparison::not_decoded: return "not_decoded";
    case PathComparison::of_ground: return "made_on_ground";
    case PathComparison::absent: break;
    }
    if (source == Source::recorded) return "never_seen_live";
    return recording_complete ? "missing_in_recording" : "pending";
}

namespace {

constexpr char other_sql[] =
    "SELECT o.octets <> u.octets, o.octets FROM packets u JOIN packets o ON o.run = u.run AND o.apid = u.apid"
    " AND o.source = 3 - u.source AND o.sclk = u.sclk AND o.packet IS NOT NULL"
    " AND substr(o.octets, 3, 2) = substr(u.octets, 3, 2) WHERE u.key = ?1 ORDER BY 1 LIMIT 1";

const std::string totals_sql = std::string("SELECT (SELECT word FROM words WHERE kind = 'link' AND number = u.link), "
                                           "u.packet, u.apid, u.source, u.standing = 1, ") +
                               path_comparison_sql +
                               ", count(*) FROM packets u WHERE u.key BETWEEN ?1 AND ?2 GROUP BY 1, 2, 3, 4, 5, 6";

constexpr char selections_sql[] =
    "SELECT octets FROM packets WHERE run = ?1 AND apid = ?2 AND source = 2 AND packet = ?3 ORDER BY sclk";

constexpr char sequences_sql[] =
    "SELECT link, packets, name, received, gaps, missing, repeated, late, restarts, wraps FROM sequence_totals"
    " WHERE run = ?1 ORDER BY link, packets, name";

constexpr double half_a_symbol_s = 5.0;  // a tone lasts 10 s; no two begin within less

void add(v1::ProofRow& row, Source source, PathComparison found, bool recording_complete, std::uint64_t packets) {
    if (found == PathComparison::not_decoded) {
        row.set_not_decoded(row.not_decoded() + packets);
    } else if (source == Source::recorded) {
        row.set_recorded(row.recorded() + packets);
        if (found == PathComparison::absent) row.set_never_seen_live(row.never_seen_live() + packets);
    } else {
        row.set_realtime(row.realtime() + packets);
        if (found == PathComparison::identical) row.set_identical(row.identical() + packets);
        if (found == PathComparison::differs) row.set_differs(row.differs() + packets);
        if (found == PathComparison::absent && recording_complete)
            row.set_missing_in_recording(row.missing_in_recording() + packets);
        if (found == PathComparison::absent && !recording_complete) row.set_pending(row.pending() + packets);
    }
}

struct Selection {
    double started_s = 0.0;
    std::uint32_t tone = 0;
    bool seen = false;  ///< the receiver decided on it, perhaps as an erasure
};

/// Every tone sent, from the recording.
Result<std::vector<Selection>> selections(Reader::State& reader, RunId run) {
    std::vector<Selection> all;
    const auto* packet = reader.dictionary.packet("ToneSelected");
    if (packet == nullptr) return all;
    const auto tone = telemetry::field_index(*packet, "tone");
    const auto started = telemetry::field_index(*packet, "started_sclk");
    auto rows = reader.query(selections_sql);
    if (!rows) return rows.error();
    (*rows)
        ->bind(1, std::int64_t{run.value})
        .bind(2, std::int64_t{packet->apid.value})
        .bind(3, static_cast<std::int64_t>(packet - reader.dictionary.packets.data()));
    for (;;) {
        auto found = (*rows)->step();
        if (!found) return found.error();
        if (!*found) return all;
        if (!tone || !started ||
            !reader.decode((*rows)->octets(0), static_cast<std::size_t>(packet - reader.dictionary.packets.data())))
            continue;
        const auto at = reader.decoded.value[*started], number = reader.decoded.value[*tone];
        if (at && number) all.push_back({*at, static_cast<std::uint32_t>(*number)});
    }
}

v1::ToneVerdict verdict_on(const ToneRecord& decided, std::vector<Selection>& sent, bool recording_complete) {
    v1::ToneVerdict verdict;
    verdict.set_sclk(decided.sclk.seconds);
    if (decided.tone) verdict.set_decoded(decided.tone->value);
    const auto distance = [&](const Selection& each) { return std::abs(each.started_s - decided.sclk.seconds); };
    const auto nearest = std::ranges::min_element(sent, {}, distance);
    const bool found = nearest != sent.end() && distance(*nearest) < half_a_symbol_s;
    if (found) {
        verdict.set_recorded(nearest->tone);
        nearest->seen = true;
    }
    if (!decided.tone)
        verdict.set_verdict("erased");
    else if (!found)
        verdict.set_verdict(recording_complete ? "missing_in_recording" : "pending");
    else
        verdict.set_verdict(decided.tone->value == nearest->tone ? "identical" : "differs");
    return verdict;
}

}  // namespace

Result<bool> Reader::State::recording_complete(RunId run) {
    auto rows = query("SELECT progress >= 1.0 FROM recordings WHERE run = ?1");
    if (!rows) return rows.error();
    (*rows)->bind(1, std::int64_t{run.value});
    auto found = (*rows)->step();
    if (!found) return found.error();
    return *found && (*rows)->integer(0) != 0;
}

Result<Reader::State::Verdict> Reader::State::verdict_on(RunId run, const PacketRecord& record,
                                                         bool recording_complete) {
    if (!record.packet) return Verdict{name_of(PathComparison::not_decoded, record.source, recording_complete)};
    if (record.link == telemetry::station_link.name)
        return Verdict{name_of(PathComparison::of_ground, record.source, recording_complete)};
    auto rows = query(other_sql);
    if (!rows) return rows.error();
    (*rows)->bind(1, item_key(run, record.seq));
    auto found = (*rows)->step();
    if (!found) return found.error();
    if (!*found) return Verdict{name_of(PathComparison::absent, record.source, recording_complete)};
    if ((*rows)->integer(0) == 0) return Verdict{name_of(PathComparison::identical, record.source, recording_complete)};
    const auto octets = (*rows)->octets(1);
    return Verdict{name_of(PathComparison::differs, record.source, recording_complete), {octets.begin(), octets.end()}};
}

Result<v1::ProofReport> Reader::proof(RunId run) {
    const auto instant = state_->instant(run);
    if (!instant) return instant.error();
    const auto complete = state_->recording_complete(run);
    if (!complete) return complete.error();
    const auto* words = state_->words_of(instant->run);

    std::map<std::string, v1::ProofRow> streams, links;
    auto rows = state_->query(totals_sql.c_str());
    if (!rows) return rows.error();
    (*rows)->bind(1, item_key(run, 0)).bind(2, item_key(run, sequence_max));
    for (;;) {
        auto found = (*rows)->step();
        if (!found) return found.error();
        if (!*found) break;
        const auto& row = **rows;
        const auto source = static_cast<Source>(row.integer(3));
        const auto comparison = static_cast<PathComparison>(row.integer(5));
        if (comparison == PathComparison::of_ground) continue;
        const auto packets = static_cast<std::uint64_t>(row.integer(6));
        const auto packet = static_cast<std::size_t>(row.integer(1));
        const bool named = words != nullptr && !row.is_null(1) && packet < words->packets.size();
        add(links[std::string{row.text(0)}], source, comparison, *complete, packets);
        const bool again = row.integer(4) != 0;
        if (!again)
            add(streams[named ? words->packets[packet].name : "APID " + std::to_string(row.integer(2))], source,
                comparison, *complete, packets);
    }
    v1::ProofReport report;
    report.set_recording_complete(*complete);
    const auto give = [](std::map<std::string, v1::ProofRow>& from, auto* into) {
        for (auto& [name, row] : from) {
            row.set_name(name);
            *into->Add() = std::move(row);
        }
    };
    give(streams, report.mutable_streams());
    give(links, report.mutable_links());
    if (auto done = add_tones(run, *complete, report); !done) return done.error();
    if (auto done = add_counters(run, report); !done) return done.error();
    return report;
}

Result<void> Reader::add_tones(RunId run, bool complete, v1::ProofReport& report) {
    auto sent = selections(*state_, run);
    if (!sent) return sent.error();
    auto rows = state_->query(rows_sql<ToneRecord>());
    if (!rows) return rows.error();
    (*rows)->bind(1, item_key(run, 0)).bind(2, item_key(run, sequence_max)).bind(3, std::int64_t{-1});
    for (;;) {
        auto found = (*rows)->step();
        if (!found) return found.error();
        if (!*found) break;
        *report.add_tones() = verdict_on(read_row<ToneRecord>(**rows), *sent, complete);
    }
    for (const Selection& each : *sent) {
        if (each.seen) continue;
        auto& verdict = *report.add_tones();
        verdict.set_sclk(each.started_s);
        verdict.set_recorded(each.tone);
        verdict.set_verdict("never_seen_live");
    }
    return {};
}

Result<void> Reader::add_counters(RunId run, v1::ProofReport& report) {
    static const std::string sql = link_totals_of_run_sql();
    auto rows = state_->query(sql.c_str());
    if (!rows) return rows.error();
    (*rows)->bind(1, std::int64_t{run.value});
    for (;;) {
        auto found = (*rows)->step();
        if (!found) return found.error();
        if (!*found) return add_sequences(run, report);
        const auto& row = **rows;
        auto& counters = *report.add_counters();
        counters.set_link(std::string{row.text(0)});
        counters.set_octets_per_s(row.real(1));
        int place = 2;
        for (const auto& column : link_total_columns())
            column.set(counters, static_cast<std::uint64_t>(row.integer(place++)));
    }
}

/// Adds the sequences of each link to its counters, which come in the same order.
Result<void> Reader::add_sequences(RunId run, v1::ProofReport& report) {
    auto rows = state_->query(sequences_sql);
    if (!rows) return rows.error();
    (*rows)->bind(1, std::int64_t{run.value});
    for (;;) {
        auto found = (*rows)->step();
        if (!found) return found.error();
        if (!*found) return {};
        const auto& row = **rows;
        const auto number = [&](int column) { return static_cast<std::uint64_t>(row.integer(column)); };
        auto& links = *report.mutable_counters();
        const auto link = std::ranges::find(links, row.text(0), &v1::LinkCounters::link);
        if (link == links.end()) continue;
        auto& sequence = *link->add_sequences();
        sequence.set_packets(number(1) != 0);
        sequence.set_name(std::string{row.text(2)});
        sequence.set_received(number(3));
        sequence.set_gaps(number(4));
        sequence.set_missing(number(5));
        sequence.set_repeated(number(6));
        sequence.set_late(number(7));
        sequence.set_restarts(number(8));
        sequence.set_wraps(number(9));
    }
}

}  // namespace aeolis::archive
