// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/archive/audit.hpp"
#include "server/archive/records.hpp"
#include "server/archive/sqlite.hpp"
#include "server/archive/writer_lock.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

// Maintenance of an archive by hand: `aeolis archive`. None of it needs a dictionary.
namespace aeolis::archive {

/// An existing archive, opened for a change that belongs to no run. Brings it up to date, marks runs that were cut off,
/// and excludes other writers until it is closed.
class Maintenance {
  public:
    static Result<Maintenance> open(const std::filesystem::path& file);

    sqlite::Database& database() { return database_; }

  private:
    Maintenance(WriterLock lock, sqlite::Database database) : lock_(std::move(lock)), database_(std::move(database)) {}

    WriterLock lock_;  // released last
    sqlite::Database database_;
};

/// A run as `aeolis archive prune` prints it.
struct RunLine {
    RunId run;
    std::string scenario, state, outcome, started;
    std::uint64_t packets = 0;
};
/// All runs, oldest first.
Result<std::vector<RunLine>> run_lines(sqlite::Database& database);

/// Deletes the runs and notes them in `pruned_runs`; all or none of them is deleted, though a crash may leave rows that
/// the next writer removes. Their numbers are not used again.
/// @param by  time, user and address for the audit entry; the action is filled in here
Result<void> prune(Maintenance& archive, const std::vector<RunId>& runs, AuditRecord by);

/// Returns the space of pruned runs to the disk. Needs as much space again while it works.
Result<void> vacuum(Maintenance& archive);

/// Copies a whole archive, as it is now, into a new file; a writer may proceed meanwhile. The copy gets its name only
/// once complete and durable.
Result<void> backup(const std::filesystem::path& file, const std::filesystem::path& copy);

/// Copies an open database, even one removed under its name; replaces `into`. Durable when it returns; leaves no file
/// when it fails.
Result<void> copy_whole(const sqlite::Database& source, const std::filesystem::path& into);

/// A sentence when anyone besides its owner may read or write the file. A new archive is its owner's alone; an older
/// one, or one opened to others by hand, keeps its mode.
std::optional<std::string> open_to_others(const std::filesystem::path& file);

/// Makes a file durable: its contents, and its name in its folder.
Result<void> make_durable(const std::filesystem::path& file);

/// The faults found by SQLite's own check of the file, one per line.
Result<std::vector<std::string>> integrity_faults(sqlite::Database& database);

/// Sequence numbers of a run that no item has, or more than one: at most `most` sentences. `schema` ("main.") prefixes
/// the names of tables in SQL.
Result<std::vector<std::string>> sequence_faults(sqlite::Database& database, RunId run, const std::string& schema,
                                                 std::size_t most);

}  // namespace aeolis::archive
