// SPDX-License-Identifier: Apache-2.0
#include "server/pipeline/derivation.hpp"

#include "server/archive/archive.hpp"
#include "server/archive/column_codec.hpp"
#include "server/archive/fingerprint.hpp"
#include "server/archive/item_rows.hpp"
#include "server/archive/row_writer.hpp"
#include "server/archive/schema.hpp"
#include "server/archive/upkeep.hpp"
#include "server/pipeline/packet_intake.hpp"

#include <algorithm>
#include <bit>
#include <unistd.h>

namespace aeolis::pipeline {

using archive::RunId;
namespace sqlite = archive::sqlite;

namespace {

constexpr std::size_t batch_packets = 4096;  ///< chosen: some MB of memory
constexpr std::size_t faults_a_table = 20;   ///< chosen: nobody reads more

struct RunToDerive {
    RunId run;
    bool finished = false;
    std::uint16_t dictionary = 0;
    double progress = 0.0;  ///< of the recording: the only total that does not follow from packets
};

/// A database of derived rows only, with the archive attached as "archive": one transaction sees a consistent state of
/// both. The file is deleted with the object.
class Scratch {
  public:
    static Result<Scratch> open(const std::filesystem::path& file, const std::filesystem::path& archive) {
        remove(file);
        auto database = sqlite::Database::open(file.string(), sqlite::Mode::read_write_create);
        if (!database) return database.error();
        Scratch scratch(file, std::move(*database));
        // Nothing in this file needs to survive a crash.
        for (const char* sql : {"PRAGMA journal_mode = OFF", "PRAGMA synchronous = OFF"})
            if (auto done = scratch.database_.execute(sql); !done) return done.error();
        if (auto done = archive::prepare_for_writing(scratch.database_); !done) return done.error();
        if (auto done = scratch.database_.attach_read_only(archive, "archive"); !done) return done.error();
        if (auto done = scratch.database_.execute("INSERT OR IGNORE INTO main.words SELECT * FROM archive.words");
            !done)
            return done.error();
        return scratch;
    }
    Scratch(Scratch&& other) noexcept : file_(std::exchange(other.file_, {})), database_(std::move(other.database_)) {}
    Scratch& operator=(Scratch&&) = delete;
    ~Scratch() {
        if (!file_.empty()) remove(file_);
    }

    sqlite::Database& database() { return database_; }
    const std::filesystem::path& file() const { return file_; }

  private:
    Scratch(std::filesystem::path file, sqlite::Database database)
        : file_(std::move(file)), database_(std::move(database)) {}
    static void remove(const std::filesystem::path& file) {
        std::error_code ignored;
        std::filesystem::remove(file, ignored);
    }

    std::filesystem::path file_;
    sqlite::Database database_;
};

Result<std::vector<RunToDerive>> runs_of(sqlite::Database& database, std::optional<RunId> only) {
    auto rows = database.prepare("SELECT r.run, r.state = 'finished', r.dictionary, coalesce(c.progress, 0)"
                                 " FROM archive.runs r LEFT JOIN archive.recordings c ON c.run = r.run"
                                 " WHERE ?1 IS NULL OR r.run = ?1 ORDER BY r.run");
    if (!rows) return rows.error();
    if (only)
        rows->bind(1, std::int64_t{only->value});
    else
        rows->bind_null(1);
    std::vector<RunToDerive> runs;
    for (;;) {
        auto found = rows->step();
        if (!found) return found.error();
        if (!*found) break;
        runs.push_back({RunId{static_cast<std::uint32_t>(rows->integer(0))}, rows->integer(1) != 0,
                        static_cast<std::uint16_t>(rows->integer(2)), rows->real(3)});
    }
    if (only && runs.empty()) return Error{"no run " + std::to_string(only->value)};
    return runs;
}

/// Compares what gives rows their meaning, above all to other programs: tables and views, the words for numbers, and the
/// names of the dictionary where a run uses it. Tables beside ours may be there, but no trigger or view.
Result<void> verify_meaning(sqlite::Database& database, const dictionary::Dictionary& dictionary, Verification& found) {
    if (auto done = archive::add_dictionary(database, dictionary); !done) return done;
    const auto id = std::to_string(dictionary.id);
    std::string sql = "SELECT DISTINCT type || ' ' || name || ': not as this program makes it' FROM ("
                      " SELECT type, name, sql FROM main.sqlite_schema EXCEPT"
                      " SELECT type, name, sql FROM archive.sqlite_schema)"
                      " UNION ALL SELECT type || ' ' || name || ': no part of an archive' FROM archive.sqlite_schema"
                      " WHERE type IN ('trigger', 'view') AND name NOT IN (SELECT name FROM main.sqlite_schema)"
                      " UNION ALL SELECT 'words: ' || kind || ' ' || number || ' is not \"' || word || '\"' FROM ("
                      " SELECT kind, number, word FROM main.words EXCEPT SELECT * FROM archive.words)";
    for (const std::string table : {"dictionaries", "dictionary_channels", "dictionary_packets"}) {
        const auto ours = "SELECT * FROM main." + table;
        const auto theirs = "SELECT * FROM archive." + table + " WHERE dictionary = " + id;
        sql += " UNION ALL SELECT '" + table + ": not what dictionary " + id + " says' WHERE EXISTS" +
               " (SELECT 1 FROM archive.runs WHERE dictionary = " + id + ") AND (EXISTS (" + ours + " EXCEPT " +
               theirs + ") OR EXISTS (" + theirs + " EXCEPT " + ours + "))";
    }
    auto rows = database.prepare(sql.c_str());
    if (!rows) return rows.error();
    for (;;) {
        auto another = rows->step();
        if (!another) return another.error();
        if (!*another) return {};
        found.faults.emplace_back(rows->text(0));
    }
}

std::string other_words(const RunToDerive& run, const dictionary::Dictionary& dictionary) {
    return "run " + std::to_string(run.run.value) + " was recorded with dictionary " + std::to_string(run.dictionary) +
           ", this program has " + std::to_string(dictionary.id);
}

/// Derives the rows of a run from "archive" into "main". @return the number of packets; none: stopped
Result<std::optional<std::size_t>> derive(sqlite::Database& database, const RunToDerive& run,
                                          const dictionary::Dictionary& dictionary,
                                          const telemetry::OtherMission* other, const ProgressCallback& on_progress) {
    const auto of_packets = database.integer_of(
        ("SELECT count(*) FROM archive.packets WHERE run = " + std::to_string(run.run.value)).c_str());
    if (!of_packets) return of_packets.error();
    auto writer = archive::RowWriter::open(database);
    if (!writer) return writer.error();
    const auto packets_sql = archive::select_sql<archive::PacketRecord>("key BETWEEN ?1 AND ?2", "archive.");
    auto packets = database.prepare(packets_sql.c_str());
    if (!packets) return packets.error();
    packets->bind(1, archive::item_key(run.run, 0))
        .bind(2, archive::item_key(run.run, archive::sequence_max))
        .bind(3, std::int64_t{-1});
    const archive::PacketColumns columns(dictionary);
    PacketIntake intake(dictionary, columns, other);
    archive::Batch batch;
    std::size_t count = 0;
    const auto stopped = [&] {
        return on_progress && !on_progress({run.run, count, static_cast<std::size_t>(*of_packets)});
    };
    if (stopped()) return std::optional<std::size_t>{};
    for (;;) {
        auto found = packets->step();
        if (!found) return found.error();
        if (!*found) break;
        const auto stored = archive::read_row<archive::PacketRecord>(*packets);
        const auto octets = archive::octets_of_packet(*packets);
        Numbering numbering(stored.seq);
        intake.take(telemetry::ReceivedPacket{{stored.link, stored.source == archive::Source::recorded},
                                              stored.ert,
                                              {octets.begin(), octets.end()}},
                    numbering, batch);
        ++count;
        if (batch.packets.size() < batch_packets) continue;
        if (stopped()) return std::optional<std::size_t>{};
        if (auto done = writer->write(run.run, batch); !done) return done.error();
        batch.clear();
    }
    if (run.finished) intake.seal(batch);
    if (count > 0) {
        batch.totals = intake.totals();
        batch.totals->progress = run.progress;
    }
    if (auto done = writer->write(run.run, batch); !done) return done.error();
    return std::optional{count};
}

/// Finds the faults of one run's tables by comparing "archive" with "main".
class Comparison {
  public:
    Comparison(sqlite::Database& database, const RunToDerive& run, const dictionary::Dictionary& dictionary,
               std::vector<std::string>& faults)
        : database_(database), run_(run), dictionary_(dictionary), faults_(faults) {}

    /// Compares all columns but `packed`, whose octets may differ though the unpacked contents are equal.
    Result<void> rows(const archive::RunTable& table, const std::string& key, const std::string& packed) {
        auto columns = columns_of(table.name, packed);
        if (!columns) return columns.error();
        const auto one_way = [&](const char* from, const char* less, const char* mark) {
            const auto of = [&](const char* schema) {
                return "SELECT " + *columns + " FROM " + schema + "." + table.name + " WHERE " + table.rows;
            };
            return std::string("SELECT ") + key + " AS item, " + mark + " AS side FROM (" + of(from) + " EXCEPT " +
                   of(less) + ")";
        };
        const std::string sql = "SELECT item, max(side = 1) + 2 * max(side = 2) FROM (" +
                                one_way("archive", "main", "1") + " UNION ALL " + one_way("main", "archive", "2") +
                                ") GROUP BY item ORDER BY item LIMIT " + std::to_string(faults_a_table);
        auto rows = database_.prepare(sql.c_str());
        if (!rows) return rows.error();
        rows->bind(1, std::int64_t{run_.run.value});
        for (;;) {
            auto found = rows->step();
            if (!found) return found.error();
            if (!*found) return {};
            const auto side = rows->integer(1);
            add(table.name, named(table.name, *rows),
                side == 1   ? "is stored, and no packet says it"
                : side == 2 ? "is missing: a packet says it"
                            : "is not what its packet says");
        }
    }

    /// Compares the unpacked contents of packed columns whose octets differ.
    Result<void> packed(const char* table, const char* sql) {
        auto rows = database_.prepare(sql);
        if (!rows) return rows.error();
        rows->bind(1, std::int64_t{run_.run.value});
        std::vector<double> stored, derived;
        for (std::size_t faults = 0; faults < faults_a_table;) {
            auto found = rows->step();
            if (!found) return found.error();
            if (!*found) break;
            derived.resize(static_cast<std::size_t>(rows->integer(1)));
            stored.resize(derived.size());
            if (auto fine = codec_.unpack(rows->octets(3), derived); !fine) return fine;
            const auto readable = codec_.unpack(rows->octets(2), stored);
            const bool same =
                readable.ok() && std::ranges::equal(stored, derived, {}, std::bit_cast<std::uint64_t, double>,
                                                    std::bit_cast<std::uint64_t, double>);
            if (same) continue;
            add(table, named(table, *rows),
                readable ? "its samples are not those of its packets" : "is damaged: " + readable.error().message);
            ++faults;
        }
        return {};
    }

  private:
    Result<std::string> columns_of(const char* table, const std::string& left_out) {
        auto rows =
            database_.prepare("SELECT group_concat(name, ', ') FROM pragma_table_info(?1, 'main') WHERE name <> ?2");
        if (!rows) return rows.error();
        rows->bind(1, std::string_view(table)).bind(2, std::string_view(left_out));
        auto found = rows->step();
        if (!found) return found.error();
        return std::string(rows->text(0));
    }
    std::string named(std::string_view table, const sqlite::Statement& row) const {
        if (table == "segments") return "segment " + std::to_string(row.integer(0));
        if (table == "segment_columns" || table == "pyramid_columns") {
            const auto channel = static_cast<std::size_t>(row.integer(0) % 65536);
            return (table == "segment_columns" ? "segment " : "block ") + std::to_string(row.integer(0) / 65536) +
                   ", channel " +
                   (channel < dictionary_.channels.size() ? dictionary_.channels[channel].name
                                                          : std::to_string(channel));
        }
        if (table == "pyramid") return "block " + std::to_string(row.integer(0));
        if (table == "recordings") return "the row";
        return "item " + std::to_string(archive::sequence_of(row.integer(0)));
    }
    void add(std::string_view table, const std::string& item, const std::string& what) {
        faults_.push_back("run " + std::to_string(run_.run.value) + ": " + std::string(table) + ": " + item + " " +
                          what);
    }

    sqlite::Database& database_;
    const RunToDerive& run_;
    const dictionary::Dictionary& dictionary_;
    std::vector<std::string>& faults_;
    archive::ColumnCodec codec_;
};

Result<void> compare(sqlite::Database& database, const RunToDerive& run, const dictionary::Dictionary& dictionary,
                     Verification& found) {
    Comparison comparison(database, run, dictionary, found.faults);
    for (const archive::RunTable& table : archive::run_tables()) {
        const std::string_view name = table.name;
        if (!table.derived) continue;
        const std::string key = name == "segments"     ? "segment"
                                : name == "recordings" ? "run"
                                : name == "pyramid"    ? "block"
                                                       : "key";
        const std::string packed = name == "segments"          ? "sclk"
                                   : name == "segment_columns" ? "value"
                                   : name == "pyramid"         ? "spans"
                                                               : "";
        if (auto done = comparison.rows(table, key, packed); !done) return done;
    }
    if (auto done = comparison.packed(
            "segments", "SELECT a.segment, b.samples, a.sclk, b.sclk FROM archive.segments a JOIN main.segments b"
                        " USING (segment) WHERE a.run = ?1 AND a.sclk <> b.sclk");
        !done)
        return done;
    if (auto done = comparison.packed(
            "pyramid", "SELECT b.block, 2 * b.nodes, a.spans, b.spans"
                       " FROM archive.pyramid a JOIN main.pyramid b USING (run, packet, source, level, position)"
                       " WHERE run = ?1 AND a.spans <> b.spans");
        !done)
        return done;
    return comparison.packed(
        "segment_columns", "SELECT a.key, s.samples, a.value, b.value FROM main.segments s JOIN main.segment_columns b"
                           " ON b.key BETWEEN s.segment * 65536 AND s.segment * 65536 + 65535"
                           " JOIN archive.segment_columns a ON a.key = b.key WHERE s.run = ?1 AND a.value <> b.value");
}

Result<void> verify_audit(sqlite::Database& database, std::optional<RunId> only,
                          const std::optional<archive::AuditHead>& known, Verification& found) {
    auto audit = archive::check_audit(database);
    if (!audit) return audit.error();
    found.faults = std::move(audit->faults);
    if (audit->entries > 0)
        found.notes.push_back("audit: " + std::to_string(audit->entries) + " entries, the last with hash " +
                              audit->last_hash);
    if (known) {
        auto fault = archive::head_fault(database, *known);
        if (!fault) return fault.error();
        if (*fault) found.faults.push_back(std::move(**fault));
    }
    auto prints = archive::check_fingerprints(database, only);
    if (!prints) return prints.error();
    found.faults.insert(found.faults.end(), prints->faults.begin(), prints->faults.end());
    found.notes.insert(found.notes.end(), prints->notes.begin(), prints->notes.end());
    return {};
}

}  // namespace

Result<Verification> verify(const std::filesystem::path& file, std::optional<RunId> only,
                            const dictionary::Dictionary& dictionary, const telemetry::OtherMission* other,
                            const std::filesystem::path& scratch_folder, const ProgressCallback& on_progress,
                            const std::optional<archive::AuditHead>& known) {
    Verification found;
    {
        auto database = sqlite::Database::open(file.string(), sqlite::Mode::read_only);
        if (!database) return database.error();
        if (auto ours = archive::check_for_reading(*database); !ours) return ours.error();
        auto faults = archive::integrity_faults(*database);
        if (!faults) return faults.error();
        for (auto& fault : *faults) found.faults.push_back("the file: " + std::move(fault));
        if (!found.faults.empty()) return found;  // with a damaged file the other checks tell nothing new
        auto moment = sqlite::Transaction::begin_read(*database);
        if (!moment) return moment.error();
        if (auto done = verify_audit(*database, only, known, found); !done) return done.error();
    }
    auto scratch = Scratch::open(scratch_folder / ("aeolis-verify-" + std::to_string(::getpid()) + ".db"), file);
    if (!scratch) return scratch.error();
    auto& database = scratch->database();
    auto transaction = sqlite::Transaction::begin_write(database);
    if (!transaction) return transaction.error();
    if (auto done = verify_meaning(database, dictionary, found); !done) return done.error();
    auto runs = runs_of(database, only);
    if (!runs) return runs.error();
    for (const RunToDerive& run : *runs) {
        ++found.runs;
        auto gaps = archive::sequence_faults(database, run.run, "archive.", faults_a_table);
        if (!gaps) return gaps.error();
        found.faults.insert(found.faults.end(), gaps->begin(), gaps->end());
        if (run.dictionary != dictionary.id) {
            found.notes.push_back(other_words(run, dictionary) + ": its derived rows were not compared");
            continue;
        }
        auto packets = derive(database, run, dictionary, other, on_progress);
        if (!packets)
            return Error{"run " + std::to_string(run.run.value) +
                         ": its packets cannot be told again: " + packets.error().message};
        found.stopped = !*packets;
        if (found.stopped) return found;
        found.packets += **packets;
        if (auto done = compare(database, run, dictionary, found); !done) return done.error();
        for (const archive::RunTable& table : archive::run_tables())
            if (auto done = database.execute((std::string("DELETE FROM main.") + table.name).c_str()); !done)
                return done.error();
    }
    return found;
}

Result<Rebuilt> rebuild(const std::filesystem::path& file, std::optional<RunId> only,
                        const dictionary::Dictionary& dictionary, const telemetry::OtherMission* other,
                        archive::AuditRecord by, const ProgressCallback& on_progress) {
    by.action = "rebuild";
    by.outcome = "done";
    auto archive = archive::Maintenance::open(file);
    if (!archive) return archive.error();
    auto scratch_file = file;
    scratch_file += "-rebuild";
    std::vector<RunToDerive> runs;
    {
        auto scratch = Scratch::open(scratch_file, file);
        if (!scratch) return scratch.error();
        auto found = runs_of(scratch->database(), only);
        if (!found) return found.error();
        runs = std::move(*found);
    }
    Rebuilt rebuilt;
    auto& database = archive->database();
    for (const RunToDerive& run : runs) {
        if (run.dictionary != dictionary.id) {
            rebuilt.left.push_back(other_words(run, dictionary));
            continue;
        }
        const auto of_run = "run " + std::to_string(run.run.value);
        auto scratch = Scratch::open(scratch_file, file);
        if (!scratch) return scratch.error();
        {
            auto transaction = sqlite::Transaction::begin_write(scratch->database());
            if (!transaction) return transaction.error();
            const auto packets = derive(scratch->database(), run, dictionary, other, on_progress);
            if (!packets) {
                rebuilt.left.push_back(of_run + ": its packets cannot be told again: " + packets.error().message);
                continue;
            }
            rebuilt.stopped = !*packets;
            if (rebuilt.stopped) break;
            if (auto done = transaction->commit(); !done) return done.error();
        }
        if (auto done = scratch->database().execute("DETACH archive"); !done) return done.error();
        if (auto done = database.attach_read_only(scratch->file(), "fresh"); !done) return done.error();
        const auto replaced = [&]() -> Result<std::vector<std::string>> {
            auto transaction = sqlite::Transaction::begin_write(database);
            if (!transaction) return transaction.error();
            for (const archive::RunTable& table : archive::run_tables()) {
                if (!table.derived) continue;
                auto taken =
                    database.prepare((std::string("DELETE FROM main.") + table.name + " WHERE " + table.rows).c_str());
                if (!taken) return taken.error();
                taken->bind(1, std::int64_t{run.run.value});
                if (auto done = taken->run(); !done) return done.error();
                const auto put = std::string("INSERT INTO main.") + table.name + " SELECT * FROM fresh." + table.name;
                if (auto done = database.execute(put.c_str()); !done) return done.error();
            }
            auto faults = archive::sequence_faults(database, run.run, "main.", 1);
            if (!faults || !faults->empty()) return faults;
            by.detail = of_run;
            if (auto noted = archive::append_audit(database, {&by, 1}); !noted) return noted.error();
            if (auto done = transaction->commit(); !done) return done.error();
            return faults;
        }();
        if (auto done = database.execute("DETACH fresh"); !done) return done.error();
        if (!replaced) return replaced.error();
        if (replaced->empty())
            rebuilt.runs.push_back(run.run);
        else
            rebuilt.left.push_back(of_run +
                                   ": its packets now say something else, and its items would get other numbers (" +
                                   replaced->front() + ")");
    }
    // The whole index: the words of damaged rows that it should forget are unknown.
    if (!rebuilt.runs.empty())
        if (auto done = database.execute("INSERT INTO search (search) VALUES ('rebuild')"); !done) return done.error();
    return rebuilt;
}

}  // namespace aeolis::pipeline
