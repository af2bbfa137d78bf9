// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/audit.hpp"
#include "server/archive/records.hpp"
#include "server/archive/sqlite.hpp"

#include <optional>
#include <span>
#include <vector>

namespace aeolis::archive {

/// Marks runs as pruned, all or none: readers no longer find them, and their numbers are not used again. Their rows
/// remain until a Pruning has removed them. Call within a transaction.
/// @param by  time, user and address for the audit entry; the action is filled in here
Result<void> mark_pruned(sqlite::Database& database, std::span<const RunId> runs, AuditRecord by);

/// Removes the rows of runs that are marked as pruned, then returns the free pages to the disk; piece by piece, so that
/// a writer proceeds between. After a crash the next Pruning continues, because all that it needs is in the archive.
class Pruning {
  public:
    static constexpr std::int64_t items_a_step = 512;      ///< chosen: some milliseconds, most of it one commit
    static constexpr std::int64_t segments_a_step = 16;    ///< chosen, likewise: of 1024 samples, with their columns
    static constexpr std::int64_t raw_pieces_a_step = 16;  ///< chosen, likewise: 1 MB at most
    static constexpr int pages_a_step = 128;               ///< chosen: 2 MB

    explicit Pruning(sqlite::Database& database) : database_(&database) {}

    /// One piece in one transaction. False: nothing is left to do.
    Result<bool> step();

  private:
    /// Removes a piece of the run; false: it has nothing left.
    Result<bool> remove_piece(RunId run);
    Result<bool> remove_items(RunId run);
    Result<bool> remove_raw(RunId run);
    Result<bool> remove_blocks(RunId run, const char* first_sql, std::span<const char* const> remove_sql);
    Result<bool> return_pages();

    sqlite::Database* database_;
    std::optional<std::vector<RunId>> runs_;  ///< runs that may have rows left; none: not read yet
};

}  // namespace aeolis::archive
