// SPDX-License-Identifier: Apache-2.0
#include "server/archive/schema.hpp"

#include "server/archive/archive.hpp"
#include "server/archive/item_rows.hpp"
#include "server/archive/link_total_columns.hpp"

#include <string_view>

namespace aeolis::archive {

namespace {

// All tables except those of items (item_tables.hpp) and of links' totals (link_total_columns.hpp), explained in
// docs/archive.md. *_sclk: seconds of the spacecraft clock; *_us: microseconds since 2000-01-01T12:00:00 UTC.
// key = run << 40 | seq.
const char* const tables_sql = R"sql(
CREATE TABLE dictionaries (
    dictionary INTEGER PRIMARY KEY, mission TEXT NOT NULL, timeline_version INTEGER NOT NULL) STRICT;
CREATE TABLE dictionary_channels (
    dictionary INTEGER NOT NULL, channel INTEGER NOT NULL, name TEXT NOT NULL, alias TEXT NOT NULL, unit TEXT NOT NULL,
    text TEXT NOT NULL, PRIMARY KEY (dictionary, channel)) STRICT, WITHOUT ROWID;
CREATE TABLE dictionary_packets (
    dictionary INTEGER NOT NULL, packet INTEGER NOT NULL, name TEXT NOT NULL, apid INTEGER NOT NULL,
    PRIMARY KEY (dictionary, packet)) STRICT, WITHOUT ROWID;

CREATE TABLE runs (
    run INTEGER PRIMARY KEY, scenario TEXT NOT NULL, title TEXT NOT NULL, venue TEXT NOT NULL, seed INTEGER NOT NULL,
    case_number INTEGER NOT NULL, pace REAL NOT NULL,
    state TEXT NOT NULL CHECK (state IN ('running', 'finished', 'interrupted')), outcome TEXT NOT NULL,
    outcome_reason TEXT NOT NULL DEFAULT '', digest TEXT NOT NULL DEFAULT '', started TEXT NOT NULL,
    ended TEXT NOT NULL DEFAULT '', last_seq INTEGER, start_sclk REAL NOT NULL, entry_sclk REAL NOT NULL,
    correlation_sclk REAL NOT NULL, correlation_scet_us INTEGER NOT NULL, clock_version INTEGER NOT NULL,
    clock_rate REAL NOT NULL, leap_seconds INTEGER NOT NULL, light_time_s REAL NOT NULL,
    tone_model TEXT NOT NULL, dictionary INTEGER NOT NULL, scenario_text TEXT NOT NULL,
    forked_run INTEGER, forked_cycle INTEGER, forked_e_s REAL, forked_seed INTEGER) STRICT;
CREATE TABLE run_solution (
    run INTEGER NOT NULL, position INTEGER NOT NULL, name TEXT NOT NULL, value REAL NOT NULL,
    PRIMARY KEY (run, position)) STRICT, WITHOUT ROWID;
CREATE TABLE run_anchors (
    run INTEGER NOT NULL, anchor INTEGER NOT NULL, name TEXT NOT NULL, predicted_e_s REAL,
    PRIMARY KEY (run, anchor)) STRICT, WITHOUT ROWID;
CREATE TABLE requests (
    run INTEGER NOT NULL, position INTEGER NOT NULL, cycle INTEGER NOT NULL, request TEXT NOT NULL,
    PRIMARY KEY (run, position)) STRICT, WITHOUT ROWID;
CREATE TABLE pruned_runs (
    run INTEGER PRIMARY KEY, scenario TEXT NOT NULL, seed INTEGER NOT NULL, case_number INTEGER NOT NULL,
    outcome TEXT NOT NULL, started TEXT NOT NULL, pruned TEXT NOT NULL) STRICT;
CREATE TABLE recordings (
    run INTEGER PRIMARY KEY, recorded INTEGER NOT NULL, recorded_octets INTEGER NOT NULL, realtime INTEGER NOT NULL,
    realtime_not_recorded INTEGER NOT NULL, realtime_differs INTEGER NOT NULL, never_seen_live INTEGER NOT NULL,
    not_decoded INTEGER NOT NULL, progress REAL NOT NULL) STRICT;

CREATE INDEX packets_by_time ON packets (run, apid, source, sclk);
CREATE TABLE segments (
    segment INTEGER PRIMARY KEY, run INTEGER NOT NULL, packet INTEGER NOT NULL, source INTEGER NOT NULL,
    position INTEGER NOT NULL, first_packet INTEGER NOT NULL, last_packet INTEGER NOT NULL, samples INTEGER NOT NULL,
    first_sclk REAL NOT NULL, last_sclk REAL NOT NULL, sclk BLOB NOT NULL) STRICT;
-- All that a plot asks of a segment but its values lies in the index: it is found in three pages less (decision 0028).
CREATE INDEX segments_by_position ON segments
    (run, packet, source, position, samples, last_packet, first_sclk, last_sclk, sclk);
CREATE TABLE segment_columns (
    key INTEGER PRIMARY KEY, defined INTEGER NOT NULL, least REAL, least_sclk REAL, largest REAL, largest_sclk REAL,
    first REAL, last REAL, value BLOB NOT NULL) STRICT;
CREATE TABLE pyramid (
    run INTEGER NOT NULL, packet INTEGER NOT NULL, source INTEGER NOT NULL, level INTEGER NOT NULL,
    position INTEGER NOT NULL, block INTEGER NOT NULL, nodes INTEGER NOT NULL, first_sclk REAL NOT NULL,
    last_sclk REAL NOT NULL, spans BLOB NOT NULL,
    PRIMARY KEY (run, packet, source, level, position)) STRICT, WITHOUT ROWID;
CREATE TABLE pyramid_columns (key INTEGER PRIMARY KEY, nodes BLOB NOT NULL) STRICT;

CREATE TABLE sequence_totals (
    run INTEGER NOT NULL, link TEXT NOT NULL, packets INTEGER NOT NULL, name TEXT NOT NULL, received INTEGER NOT NULL,
    gaps INTEGER NOT NULL, missing INTEGER NOT NULL, repeated INTEGER NOT NULL, late INTEGER NOT NULL,
    restarts INTEGER NOT NULL, wraps INTEGER NOT NULL, PRIMARY KEY (run, link, packets, name)) STRICT, WITHOUT ROWID;
CREATE TABLE raw_octets (
    run INTEGER NOT NULL, link TEXT NOT NULL, first INTEGER NOT NULL, ert_us INTEGER NOT NULL, octets BLOB NOT NULL,
    PRIMARY KEY (run, link, first)) STRICT, WITHOUT ROWID;

CREATE TABLE audit (
    entry INTEGER PRIMARY KEY, at TEXT NOT NULL, who TEXT NOT NULL, peer TEXT NOT NULL, action TEXT NOT NULL,
    detail TEXT NOT NULL, outcome TEXT NOT NULL, hash TEXT NOT NULL) STRICT;

-- What was asked of what would come of a run; no part of what it recorded (forecasts.hpp).
CREATE TABLE forecasts (
    run INTEGER NOT NULL, number INTEGER NOT NULL, asked TEXT NOT NULL, asked_by TEXT NOT NULL, at_e_s REAL NOT NULL,
    request TEXT NOT NULL, state TEXT NOT NULL, reason TEXT NOT NULL, result TEXT NOT NULL, ended TEXT NOT NULL,
    PRIMARY KEY (run, number)) STRICT, WITHOUT ROWID;

CREATE TABLE layouts (
    owner TEXT NOT NULL, name TEXT NOT NULL, view TEXT NOT NULL, saved TEXT NOT NULL,
    PRIMARY KEY (owner, name)) STRICT, WITHOUT ROWID;

CREATE TABLE words (kind TEXT NOT NULL, number INTEGER NOT NULL, word TEXT NOT NULL, PRIMARY KEY (kind, number))
    STRICT, WITHOUT ROWID;
INSERT INTO words VALUES
    ('link', 1, 'uhf_live'), ('link', 2, 'relay'), ('link', 3, 'x_band'),
    ('source', 1, 'realtime'), ('source', 2, 'recorded'), ('source', 3, 'ground'),
    ('standing', 0, 'first'), ('standing', 1, 'again'), ('standing', 2, 'duplicate'), ('standing', 3, 'differs'),
    ('standing', 4, 'unregistered');
)sql";

// Views for people who open the file with other tools: run, seq, words and UTC instead of keys, numbers and
// microseconds.
const char* const views_sql = R"sql(
CREATE VIEW packet_log AS
    SELECT u.run, u.key & 0xFFFFFFFFFF AS seq, p.name, u.apid, u.sclk,
           strftime('%Y-%jT%H:%M:%f', u.ert_us / 1e6 + 946728000, 'unixepoch') AS ert, l.word AS link,
           s.word AS source, d.word AS standing, u.refusal, length(u.octets) AS octets, hex(u.octets) AS hex
    FROM packets u JOIN runs r ON r.run = u.run
    LEFT JOIN dictionary_packets p ON p.dictionary = r.dictionary AND p.packet = u.packet
    JOIN words l ON l.kind = 'link' AND l.number = u.link
    JOIN words s ON s.kind = 'source' AND s.number = u.source
    JOIN words d ON d.kind = 'standing' AND d.number = u.standing;
CREATE VIEW event_log AS
    SELECT e.key >> 40 AS run, e.key & 0xFFFFFFFFFF AS seq, e.sclk, e.sclk - nullif(r.entry_sclk, 0) AS e_s,
           strftime('%Y-%jT%H:%M:%f', e.ert_us / 1e6 + 946728000, 'unixepoch') AS ert, e.level, e.name, e.text,
           s.word AS source, e.duplicate
    FROM events e JOIN runs r ON r.run = e.key >> 40 JOIN words s ON s.kind = 'source' AND s.number = e.source;
CREATE VIEW tone_log AS
    SELECT t.key >> 40 AS run, t.key & 0xFFFFFFFFFF AS seq,
           strftime('%Y-%jT%H:%M:%f', t.start_us / 1e6 + 946728000, 'unixepoch') AS ert_start, t.tone, t.name,
           t.meaning, t.likelihood, t.runner_up, t.c_n0_dbhz, t.lock = 'locked' AS locked, t.model
    FROM tones t;
CREATE VIEW command_log AS
    SELECT c.key >> 40 AS run, c.key & 0xFFFFFFFFFF AS seq, c.command, c.name, c.stage, c.status, c.evidence,
           strftime('%Y-%jT%H:%M:%f', c.ert_us / 1e6 + 946728000, 'unixepoch') AS at
    FROM command_stages c;
CREATE VIEW timeline_log AS
    SELECT f.key >> 40 AS run, f.key & 0xFFFFFFFFFF AS seq, f.timepoint, f.name, f.fired_sclk,
           f.fired_sclk - nullif(r.entry_sclk, 0) AS e_s, f.triggered_sclk, f.verdict, s.word AS source, f.duplicate
    FROM timepoint_firings f JOIN runs r ON r.run = f.key >> 40
    JOIN words s ON s.kind = 'source' AND s.number = f.source;
CREATE VIEW explanation_log AS
    SELECT x.key >> 40 AS run, x.key & 0xFFFFFFFFFF AS seq, x.sclk, x.sclk - nullif(r.entry_sclk, 0) AS e_s, x.decision,
           x.verdict, x.subject, x.text, x.duplicate
    FROM explanations x JOIN runs r ON r.run = x.key >> 40;
CREATE VIEW alarm_log AS
    SELECT a.key >> 40 AS run, a.key & 0xFFFFFFFFFF AS seq, a.sclk, c.name AS channel, a.severity, a.value, c.unit,
           a.limit_text
    FROM alarms a JOIN runs r ON r.run = a.key >> 40
    JOIN dictionary_channels c ON c.dictionary = r.dictionary AND c.channel = a.channel;
CREATE VIEW channel_segments AS
    SELECT g.run, c.name AS channel, c.unit, s.word AS source, g.position, g.samples, g.first_sclk, g.last_sclk,
           v.defined, v.least, v.least_sclk, v.largest, v.largest_sclk, v.first, v.last, g.sclk AS sclk_blob,
           v.value AS value_blob
    FROM segment_columns v JOIN segments g ON g.segment = v.key / 65536 JOIN runs r ON r.run = g.run
    JOIN dictionary_channels c ON c.dictionary = r.dictionary AND c.channel = v.key % 65536
    JOIN words s ON s.kind = 'source' AND s.number = g.source;
CREATE VIEW tone_evidence_log AS
    SELECT t.key >> 40 AS run, t.key & 0xFFFFFFFFFF AS seq,
           strftime('%Y-%jT%H:%M:%f', t.start_us / 1e6 + 946728000, 'unixepoch') AS ert_start, t.tone, t.c_n0_dbhz,
           t.doppler_hz, t.lock, t.model, hex(t.spectrum) AS spectrum,
           (SELECT group_concat(tone || ': ' || round(likelihood, 6), ', ')
            FROM (SELECT tone, likelihood FROM tone_likelihoods WHERE key = t.key ORDER BY position)) AS best
    FROM tones t;
CREATE VIEW staleness_log AS
    SELECT s.key >> 40 AS run, s.key & 0xFFFFFFFFFF AS seq,
           strftime('%Y-%jT%H:%M:%f', s.ert_us / 1e6 + 946728000, 'unixepoch') AS ert, p.name AS packet, s.stale,
           s.silent_s, s.expected_s, s.reason
    FROM staleness s JOIN runs r ON r.run = s.key >> 40
    JOIN dictionary_packets p ON p.dictionary = r.dictionary AND p.packet = s.packet;
CREATE VIEW situation_log AS
    SELECT p.key >> 40 AS run, p.key & 0xFFFFFFFFFF AS seq,
           strftime('%Y-%jT%H:%M:%f', s.ert_us / 1e6 + 946728000, 'unixepoch') AS ert, p.position, p.rank, p.subject,
           p.sentence, p.evidence, p.evidence_seq, p.awaited,
           strftime('%Y-%jT%H:%M:%f', p.at_us / 1e6 + 946728000, 'unixepoch') AS at, p.overdue, p.timepoint
    FROM situation_entries p JOIN situations s ON s.key = p.key;
CREATE VIEW alarm_action_log AS
    SELECT a.key >> 40 AS run, a.key & 0xFFFFFFFFFF AS seq,
           strftime('%Y-%jT%H:%M:%f', a.ert_us / 1e6 + 946728000, 'unixepoch') AS at, a.alarm, a.action, a.author,
           a.note,
           CASE WHEN a.until_us > a.ert_us
                THEN strftime('%Y-%jT%H:%M:%f', a.until_us / 1e6 + 946728000, 'unixepoch') END AS until
    FROM alarm_actions a;
CREATE VIEW shift_log AS
    SELECT n.key >> 40 AS run, n.key & 0xFFFFFFFFFF AS seq,
           strftime('%Y-%jT%H:%M:%f', n.ert_us / 1e6 + 946728000, 'unixepoch') AS at, n.written, n.author, n.sclk,
           n.sclk - nullif(r.entry_sclk, 0) AS e_s, n.text, nullif(n.call, '') AS call,
           nullif(n.position, '') AS position, nullif(n.reads_back, 0) AS reads_back
    FROM notes n JOIN runs r ON r.run = n.key >> 40;
CREATE VIEW procedure_log AS
    SELECT a.key >> 40 AS run, a.key & 0xFFFFFFFFFF AS seq,
           strftime('%Y-%jT%H:%M:%f', a.ert_us / 1e6 + 946728000, 'unixepoch') AS at, a.number, a.procedure, a.kind,
           a.step, a.position, a.author, a.reason, a.choice, nullif(a.command, 0) AS command
    FROM procedure_acts a;
CREATE VIEW position_log AS
    SELECT a.key >> 40 AS run, a.key & 0xFFFFFFFFFF AS seq,
           strftime('%Y-%jT%H:%M:%f', a.ert_us / 1e6 + 946728000, 'unixepoch') AS at, a.position, a.kind, a.author,
           nullif(a.offered_to, '') AS offered_to, nullif(a.subject, '') AS subject, nullif(a.reason, '') AS reason
    FROM position_acts a;
CREATE VIEW clock_log AS
    SELECT r.run, r.scenario, r.clock_version AS version, r.correlation_sclk AS sclk,
           strftime('%Y-%jT%H:%M:%f', r.correlation_scet_us / 1e6 + 946728000, 'unixepoch') AS scet,
           r.clock_rate - 1.0 AS drift, r.leap_seconds, nullif(r.entry_sclk, 0) AS entry_sclk,
           strftime('%Y-%jT%H:%M:%f', r.correlation_scet_us / 1e6
               + (nullif(r.entry_sclk, 0) - r.correlation_sclk) * r.clock_rate + 946728000, 'unixepoch') AS entry_scet,
           r.light_time_s
    FROM runs r;
CREATE VIEW command_wait_log AS
    SELECT c.key >> 40 AS run, c.key & 0xFFFFFFFFFF AS seq,
           strftime('%Y-%jT%H:%M:%f', c.ert_us / 1e6 + 946728000, 'unixepoch') AS at, c.command, c.name, c.held,
           c.needs_approval, c.asked_by, c.evidence
    FROM command_stages c WHERE c.held OR c.needs_approval;
CREATE VIEW commands AS
    SELECT key >> 40 AS run, command, name, arguments, count, client_id, octets FROM command_stages
    WHERE octets IS NOT NULL;
)sql";

// Page size of a new archive; SQLite's default is 4 kB. A pyramid block or a packed column fits one page, and trees are
// a level less deep: a plot opened first reads a third of the pages. docs/decisions/0028
constexpr char page_size_sql[] = "PRAGMA page_size = 16384; PRAGMA auto_vacuum = INCREMENTAL";  // Pruning

constexpr char by_key[] = "key BETWEEN ?1 << 40 AND ?1 << 40 | 0xFFFFFFFFFF";
constexpr char by_run[] = "run = ?1";
constexpr char by_block[] = "key BETWEEN ?1 << 39 AND (?1 << 39) + 0x7FFFFFFFFF";
constexpr char by_rowid[] = "rowid BETWEEN ?1 << 40 AND ?1 << 40 | 0xFFFFFFFFFF";
std::vector<RunTable> tables_of_runs() {
    std::vector<RunTable> tables{
        {"search", by_rowid, false},
        {"segment_columns", by_block, true},
        {"segments", by_run, true},
        {"pyramid_columns", by_block, true},
        {"pyramid", by_run, true},
        {"recordings", by_run, true},
        {"link_totals", by_run, false},
        {"requests", by_run, false},
        {"sequence_totals", by_run, false},
        {"raw_octets", by_run, false},
        {"run_solution", by_run, false},
        {"run_anchors", by_run, false},
        {"runs", by_run, false},
    };
    for_item_kinds([&]<typename Record>(ItemKind<Record>) {
        if constexpr (HasParts<Record>)
            tables.push_back({PartTable<PartOf<Record>>::name, by_key, ItemTable<Record>::derived});
        tables.push_back({ItemTable<Record>::name, by_key, ItemTable<Record>::derived});
    });
    return tables;
}

std::string item_tables_sql() {
    std::string sql;
    const auto declared = [](const auto& columns) { return joined(columns, &ColumnText::declared, ", "); };
    for_item_kinds([&]<typename Record>(ItemKind<Record>) {
        sql += std::string("CREATE TABLE ") + ItemTable<Record>::name +
               " (key INTEGER PRIMARY KEY, ert_us INTEGER NOT NULL, " + declared(columns_of<ItemTable, Record>()) +
               ") STRICT;";
        if constexpr (HasParts<Record>)
            sql += std::string("CREATE TABLE ") + PartTable<PartOf<Record>>::name +
                   " (key INTEGER NOT NULL, position INTEGER NOT NULL, " +
                   declared(columns_of<PartTable, PartOf<Record>>()) +
                   ", PRIMARY KEY (key, position)) STRICT, WITHOUT ROWID;";
    });
    return sql;
}

// The table "search" indexes the words of the view search_text and stores no text: its rows must be removed before
// those of the table.
std::string search_sql() {
    std::string sql;
    for_item_kinds([&]<typename Record>(ItemKind<Record>) {
        auto columns = columns_of<ItemTable, Record>();
        std::erase_if(columns, [](const ColumnText& column) { return !column.searched; });
        if (columns.empty()) return;
        sql += (sql.empty() ? "CREATE VIEW search_text AS SELECT key, " : " UNION ALL SELECT key, ") +
               joined(columns, &ColumnText::name, " || ' ' || ") + " AS text FROM " + ItemTable<Record>::name;
    });
    return sql + "; CREATE VIRTUAL TABLE search USING fts5(text, content = 'search_text', content_rowid = 'key')";
}

Error not_ours(const sqlite::Database& database) {
    return {database.file() + " is not an Aeolis archive"};
}

/// @param why  "was written …"
Error of_another_build(const sqlite::Database& database, const std::string& why) {
    return {database.file() + " " + why + ": open it with the Aeolis that wrote it, or name another file"};
}

constexpr std::int64_t before_release_id =
    0x41454F4C;  ///< "AEOL": archives made before the first release, of other tables

/// Whether the database is empty. An Error when it is neither empty nor of our schema.
Result<bool> is_empty(sqlite::Database& database) {
    auto id = database.integer_of("PRAGMA application_id");
    if (!id) {
        // SQLite's message for a file of another format; its other messages are clear.
        if (id.error().message.find("not a database") != std::string::npos) return not_ours(database);
        return id.error();
    }
    auto version = database.integer_of("PRAGMA user_version");
    auto tables = database.integer_of("SELECT count(*) FROM sqlite_schema");
    if (!version) return version.error();
    if (!tables) return tables.error();
    if (*id == 0 && *version == 0 && *tables == 0) return true;
    if (*id == before_release_id)
        return of_another_build(database, "was written before the first release, in another layout");
    if (*id != application_id || *version < 1) return not_ours(database);
    if (*version == schema_version) {
        const auto whole = database.integer_of("SELECT count(*) FROM pragma_table_info('link_totals')"
                                               " WHERE name = 'corrected_headers'");
        if (!whole) return whole.error();
        if (*whole == 0)
            return of_another_build(database, "was written by a build of before 0.2.0, with other counters of links");
        return false;
    }
    const auto why =
        "has archive schema " + std::to_string(*version) + ", this program has " + std::to_string(schema_version);
    return of_another_build(database, why);
}

}  // namespace

const std::vector<RunTable>& run_tables() {
    static const std::vector<RunTable> tables = tables_of_runs();
    return tables;
}

const char* last_key_sql() {
    static const std::string sql = [] {
        std::string keys = "SELECT (SELECT key + sampled FROM packets WHERE key BETWEEN ?1 AND ?2 ORDER BY key DESC"
                           " LIMIT 1) AS key";
        for_item_kinds([&]<typename Record>(ItemKind<Record>) {
            keys += std::string(" UNION ALL SELECT max(key) FROM ") + ItemTable<Record>::name +
                    " WHERE key BETWEEN ?1 AND ?2";
        });
        return "SELECT max(key) FROM (" + keys + ")";
    }();
    return sql.c_str();
}

Result<void> prepare_for_writing(sqlite::Database& database) {
    auto empty = is_empty(database);
    if (!empty) return empty.error();
    if (!*empty) return {};
    if (auto done = database.execute(page_size_sql); !done) return done;
    // One transaction, before WAL is switched on: after a crash the file is empty or a whole archive.
    auto transaction = sqlite::Transaction::begin_write(database);
    if (!transaction) return transaction.error();
    const std::string marks = "PRAGMA application_id = " + std::to_string(application_id) +
                              "; PRAGMA user_version = " + std::to_string(schema_version);
    for (const std::string& sql : {marks, item_tables_sql(), std::string(tables_sql), link_totals_table_sql(),
                                   std::string(views_sql), search_sql()})
        if (auto done = database.execute(sql.c_str()); !done) return done;
    return transaction->commit();
}

Result<void> check_for_reading(sqlite::Database& database) {
    auto empty = is_empty(database);
    if (!empty) return empty.error();
    return *empty ? not_ours(database) : Result<void>{};
}

Result<void> add_dictionary(sqlite::Database& database, const dictionary::Dictionary& dictionary) {
    const std::int64_t id = dictionary.id;
    auto known =
        database.integer_of(("SELECT count(*) FROM dictionaries WHERE dictionary = " + std::to_string(id)).c_str());
    if (!known) return known.error();
    if (*known != 0) return {};
    auto whole = database.prepare("INSERT INTO dictionaries VALUES (?,?,?)");
    auto channel_row = database.prepare("INSERT INTO dictionary_channels VALUES (?,?,?,?,?,?)");
    auto packet_row = database.prepare("INSERT INTO dictionary_packets VALUES (?,?,?,?)");
    for (const auto* statement : {&whole, &channel_row, &packet_row})
        if (!*statement) return statement->error();
    whole->bind(1, id).bind(2, std::string_view(dictionary.mission)).bind(3, std::int64_t{dictionary.timeline_version});
    if (auto done = whole->run(); !done) return done;
    for (const auto& channel : dictionary.channels) {
        channel_row->bind(1, id)
            .bind(2, std::int64_t{channel.id.value})
            .bind(3, std::string_view(channel.name))
            .bind(4, std::string_view(channel.alias))
            .bind(5, std::string_view(channel.type.unit))
            .bind(6, std::string_view(channel.text));
        if (auto done = channel_row->run(); !done) return done;
    }
    for (std::size_t i = 0; i < dictionary.packets.size(); ++i) {
        const auto& packet = dictionary.packets[i];
        packet_row->bind(1, id)
            .bind(2, sqlite::number(i))
            .bind(3, std::string_view(packet.name))
            .bind(4, std::int64_t{packet.apid.value});
        if (auto done = packet_row->run(); !done) return done;
    }
    return {};
}

}  // namespace aeolis::archive
