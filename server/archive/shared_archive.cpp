// SPDX-License-Identifier: Apache-2.0
#include "server/archive/shared_archive.hpp"

#include "server/archive/audit.hpp"
#include "server/archive/fingerprint.hpp"
#include "server/archive/schema.hpp"

#include <utility>

namespace aeolis::archive {
namespace {

/// A follower's writer commits nothing, so that its log would grow without end. Chosen: as that writer's own limits,
/// with pages of 16 kB.
constexpr char moves_log_sql[] = "PRAGMA wal_autocheckpoint = 1000; PRAGMA journal_size_limit = 16384000";

Result<std::unique_ptr<sqlite::Database>> connect(const std::filesystem::path& file) {
    auto opened = sqlite::Database::open(file.string(), sqlite::Mode::read_write_create);
    if (!opened) return opened.error();
    auto database = std::make_unique<sqlite::Database>(std::move(*opened));
    if (auto ours = check_for_reading(*database); !ours) return ours.error();
    // The writer moves its log into the file.
    if (auto set = database->execute("PRAGMA synchronous = FULL; PRAGMA wal_autocheckpoint = 0"); !set)
        return set.error();
    return database;
}

}  // namespace

SharedArchive::SharedArchive(std::unique_ptr<sqlite::Database> database)
    : database_(std::move(database)), rows_(*database_) {}

Result<SharedArchive> SharedArchive::open(const std::filesystem::path& file) {
    auto database = connect(file);
    if (!database) return database.error();
    return SharedArchive{std::move(*database)};
}

Result<void> SharedArchive::in_place() {
    if (!database_->moved()) return {};
    auto database = connect(database_->file());
    if (!database) return database.error();
    rows_ = RunRowsWriter{**database};
    database_ = std::move(*database);
    return {};
}

Result<std::string> SharedArchive::identity() {
    return cluster_identity(*database_);
}
Result<std::string> SharedArchive::fact(const std::string& name) {
    return cluster_fact(*database_, name);
}
Result<void> SharedArchive::keep_fact(const std::string& name, const std::string& value) {
    return keep_cluster_fact(*database_, name, value);
}
Result<std::string> SharedArchive::followed() {
    return cluster_fact(*database_, fact_origin);
}
Result<std::string> SharedArchive::tables() {
    return tables_digest(*database_);
}
Result<v1::RunPosition> SharedArchive::position(RunId run) {
    return position_of(*database_, run);
}
Result<bool> SharedArchive::is_settled(RunId run, Sequence last) {
    const auto of_run = " WHERE run = " + std::to_string(run.value);
    const auto pruned = database_->integer_of(("SELECT count(*) FROM pruned_runs" + of_run).c_str());
    if (!pruned) return pruned.error();
    if (*pruned != 0) return true;
    const auto over = database_->integer_of(("SELECT count(*) FROM runs" + of_run + " AND state <> 'running'").c_str());
    if (!over) return over.error();
    const auto here = position(run);
    if (!here) return here.error();
    return *over != 0 && here->seq() >= last;
}
Result<std::map<std::uint32_t, PublishedRun>> SharedArchive::published() {
    return published_runs(*database_);
}

Result<void> SharedArchive::follow(const std::string& origin) {
    const auto already = followed();
    if (!already) return already.error();
    if (*already == origin) return {};
    if (!already->empty())
        return Error{database_->file() + " follows the archive " + *already + ", not " + origin +
                     ": name another file"};
    const auto own = identity();
    if (!own) return own.error();
    const auto runs = database_->integer_of("SELECT count(*) FROM runs");
    if (!runs) return runs.error();
    if (*runs != 0 && *own != origin)
        return Error{database_->file() + " has runs of its own and is no copy of the archive " + origin +
                     ": name another file"};
    auto transaction = sqlite::Transaction::begin_write(*database_);
    if (!transaction) return transaction.error();
    if (*own == origin)  // a copy, which is another archive from here on
        if (auto done = database_->execute("DELETE FROM cluster; DELETE FROM published_runs"); !done) return done;
    if (auto made = cluster_identity(*database_); !made) return made.error();
    if (auto done = keep_cluster_fact(*database_, fact_origin, origin); !done) return done;
    return transaction->commit();
}

Result<void> SharedArchive::stop_following() {
    auto transaction = sqlite::Transaction::begin_write(*database_);
    if (!transaction) return transaction.error();
    for (const auto* name : {fact_origin, fact_taken})
        if (auto done = keep_cluster_fact(*database_, name, ""); !done) return done;
    return transaction->commit();
}

Result<void> SharedArchive::keep_published(std::span<const PublishedRun> runs, const std::string& stream) {
    if (auto done = in_place(); !done) return done;
    // Without a sync of the disk, for which the archive's writer would wait: what a power cut takes back, the engine
    // knows.
    if (auto set = database_->execute("PRAGMA synchronous = NORMAL"); !set) return set;
    auto transaction = sqlite::Transaction::begin_write(*database_);
    if (!transaction) return transaction.error();
    const auto known = cluster_fact(*database_, fact_published);
    if (!known) return known.error();
    if (auto done = keep_published_runs(*database_, runs, *known != stream); !done) return done;
    if (*known != stream)
        if (auto done = keep_cluster_fact(*database_, fact_published, stream); !done) return done;
    if (auto done = transaction->commit(); !done) return done;
    return database_->execute("PRAGMA synchronous = FULL");
}

Result<SharedArchive::Items> SharedArchive::take(RunId run, const RunStep& step, const std::string& place) {
    if (auto done = in_place(); !done) return done.error();
    if (auto set = database_->execute(moves_log_sql); !set) return set.error();
    auto transaction = sqlite::Transaction::begin_write(*database_);
    if (!transaction) return transaction.error();
    if (auto done = keep_cluster_fact(*database_, fact_taken, place); !done) return done.error();
    const auto of_run = " WHERE run = " + std::to_string(run.value);
    const auto pruned = database_->integer_of(("SELECT count(*) FROM pruned_runs" + of_run).c_str());
    if (!pruned) return pruned.error();
    Items added;
    if (*pruned == 0) {
        const auto ended =
            database_->integer_of(("SELECT count(*) FROM runs" + of_run + " AND state = 'finished'").c_str());
        if (!ended) return ended.error();
        const auto taken = rows_.take(run, step);
        if (!taken) return taken.error();
        added = {taken->first, taken->last};
        if (taken->ended && step.rows.whole())
            if (auto done = add_fingerprint_of_end(run, step, *ended != 0, added); !done) return done.error();
    }
    if (auto done = transaction->commit(); !done) return done.error();
    return added;
}

Result<void> SharedArchive::add_fingerprint(RunId run, Sequence first, Sequence last) {
    const auto record = fingerprint(*database_, run, first, last);
    if (!record) return record.error();
    return append_audit(*database_, {&*record, 1});
}

/// Of a run that has ended here with this step, or got more items since.
Result<void> SharedArchive::add_fingerprint_of_end(RunId run, const RunStep& step, bool ended_before,
                                                   const Items& added) {
    if (ended_before) return added.last == 0 ? Result<void>{} : add_fingerprint(run, added.first, added.last);
    const auto wanted = fingerprint_range(step.rows.fingerprint());
    if (!wanted) return add_fingerprint(run, 1, step.after.seq());  // its origin ended it before there were any
    const auto record = fingerprint(*database_, run, wanted->first, wanted->last);
    if (!record) return record.error();
    if (record->detail != step.rows.fingerprint())
        return Error{"the rows that came are not those that its origin's audit has the fingerprint of"};
    if (auto done = append_audit(*database_, {&*record, 1}); !done) return done;
    return wanted->last < step.after.seq() ? add_fingerprint(run, wanted->last + 1, step.after.seq()) : Result<void>{};
}

}  // namespace aeolis::archive
