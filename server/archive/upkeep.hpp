// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/archive/audit.hpp"
#include "server/archive/records.hpp"
#include "server/archive/sqlite.hpp"
#include "server/archive/writer_lock.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

// What is done to an archive now and then, by hand: `aeolis archive`. None of it needs a dictionary.
namespace aeolis::archive {

/// An archive that is there, for a change that is not a run's: brought up to date, runs that were cut off marked, and
/// no other writer until it is closed.
class Maintenance {
  public:
    static Result<Maintenance> open(const std::filesystem::path& file);

    sqlite::Database& database() { return database_; }

  private:
    Maintenance(WriterLock lock, sqlite::Database database) : lock_(std::move(lock)), database_(std::move(database)) {}

    WriterLock lock_;  // released last
    sqlite::Database database_;
};

/// As `aeolis archive prune` prints it.
struct RunLine {
    RunId run;
    std::string scenario, state, outcome, started;
    std::uint64_t units = 0;
};
/// All runs, oldest first.
Result<std::vector<RunLine>> run_lines(sqlite::Database& database);

/// Takes the runs away, all of them or none, and notes in `pruned_runs` that they were there. Their numbers are not
/// given again. The file keeps its size until it is vacuumed.
/// @param by  when, who and from where, of the entry in the audit; what was done is added here
Result<void> prune(Maintenance& archive, const std::vector<RunId>& runs, AuditRecord by);

/// Gives the room that pruned runs left back to the disk; needs as much again while it works.
Result<void> vacuum(Maintenance& archive);

/// A whole archive, as it is now, into a file that is not there yet; a writer goes on meanwhile. The copy has its name
/// only when it is complete and durable.
Result<void> backup(const std::filesystem::path& file, const std::filesystem::path& copy);

/// The same of a database that is open, whatever has become of its name; `into` is replaced if it is there. Leaves it
/// durable, and nothing when it fails.
Result<void> copy_whole(const sqlite::Database& source, const std::filesystem::path& into);

/// Durable: the file's contents, and its name in its folder.
Result<void> make_durable(const std::filesystem::path& file);

/// SQLite's own check of the file, a line a fault; empty: none.
Result<std::vector<std::string>> integrity_faults(sqlite::Database& database);

/// Sequence numbers of a run that no item has, or more than one, in words; at most `most`. SQL names of tables are
/// prefixed by `schema` ("main.").
Result<std::vector<std::string>> sequence_faults(sqlite::Database& database, RunId run, const std::string& schema,
                                                 std::size_t most);

}  // namespace aeolis::archive
