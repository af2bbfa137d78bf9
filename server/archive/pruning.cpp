// SPDX-License-Identifier: Apache-2.0
#include "server/archive/pruning.hpp"

#include "server/archive/item_tables.hpp"
#include "server/archive/schema.hpp"

#include <algorithm>
#include <array>

namespace aeolis::archive {
namespace {

/// SQL for the first key of a run's items, between ?1 and ?2.
std::string first_key_sql() {
    std::string sql;
    for_item_kinds([&]<typename Record>(ItemKind<Record>) {
        sql += std::string(sql.empty() ? "SELECT min(key) FROM (" : " UNION ALL ") + "SELECT min(key) AS key FROM " +
               ItemTable<Record>::name + " WHERE key BETWEEN ?1 AND ?2";
    });
    return sql + ")";
}

/// SQL that removes items with keys ?1 to ?2. The index of words first: it forgets the words of rows that are there.
std::vector<std::string> remove_items_sql() {
    std::vector<std::string> sql{"DELETE FROM search WHERE rowid BETWEEN ?1 AND ?2"};
    for_item_kinds([&]<typename Record>(ItemKind<Record>) {
        if constexpr (HasParts<Record>)
            sql.push_back(std::string("DELETE FROM ") + PartTable<PartOf<Record>>::name +
                          " WHERE key BETWEEN ?1 AND ?2");
        sql.push_back(std::string("DELETE FROM ") + ItemTable<Record>::name + " WHERE key BETWEEN ?1 AND ?2");
    });
    return sql;
}

constexpr char first_segment_sql[] = "SELECT min(segment) FROM segments WHERE run = ?1";
constexpr std::array remove_segments_sql{
    "DELETE FROM segment_columns WHERE key >= ?2 << 16 AND key < min(?3, (?1 + 1) << 23) << 16",
    "DELETE FROM segments WHERE run = ?1 AND segment >= ?2 AND segment < ?3"};
constexpr char first_block_sql[] = "SELECT min(block) FROM pyramid WHERE run = ?1";
constexpr std::array remove_blocks_sql{
    "DELETE FROM pyramid_columns WHERE key >= ?2 << 16 AND key < min(?3, (?1 + 1) << 23) << 16",
    "DELETE FROM pyramid WHERE run = ?1 AND block >= ?2 AND block < ?3"};
constexpr std::array tables_of_run{"recordings",   "link_totals", "sequence_totals", "requests",
                                   "run_solution", "run_anchors", "forecasts"};

/// The number that the statement selects; none: NULL.
Result<std::optional<std::int64_t>> number_of(sqlite::Statement& statement) {
    auto found = statement.step();
    if (!found) return found.error();
    std::optional<std::int64_t> number;
    if (*found && !statement.is_null(0)) number = statement.integer(0);
    statement.reset();
    return number;
}

Result<void> remove_rows(sqlite::Database& database, const std::string& sql, std::span<const std::int64_t> bound) {
    auto rows = database.prepare(sql.c_str());
    if (!rows) return rows.error();
    for (std::size_t i = 0; i < bound.size(); ++i) rows->bind(static_cast<int>(i) + 1, bound[i]);
    return rows->run();
}

}  // namespace

Result<void> mark_pruned(sqlite::Database& database, std::span<const RunId> runs, AuditRecord by) {
    auto note = database.prepare("INSERT INTO pruned_runs SELECT run, scenario, seed, case_number, outcome, started,"
                                 " strftime('%Y-%m-%dT%H:%M:%SZ') FROM runs WHERE run = ?1 AND state <> 'running'"
                                 " RETURNING run");
    if (!note) return note.error();
    for (const RunId run : runs) {
        note->bind(1, std::int64_t{run.value});
        auto found = note->step();
        if (!found) return found.error();
        if (!*found) return Error{"no run " + std::to_string(run.value) + " that is over in " + database.file()};
        note->reset();
        const std::array bound{std::int64_t{run.value}};
        if (auto done = remove_rows(database, "DELETE FROM runs WHERE run = ?1", bound); !done) return done;
        by.detail += (by.detail.empty() ? "runs " : ", ") + std::to_string(run.value);
    }
    by.action = "prune";
    by.outcome = "done";
    return append_audit(database, {&by, 1});
}

Result<bool> Pruning::step() {
    if (!runs_) {
        auto rows = database_->prepare("SELECT run FROM pruned_runs ORDER BY run");
        if (!rows) return rows.error();
        std::vector<RunId> runs;
        for (;;) {
            auto found = rows->step();
            if (!found) return found.error();
            if (!*found) break;
            runs.push_back({static_cast<std::uint32_t>(rows->integer(0))});
        }
        runs_ = std::move(runs);
    }
    while (!runs_->empty()) {
        auto removed = remove_piece(runs_->back());
        if (!removed || *removed) return removed;
        runs_->pop_back();
    }
    auto returned = return_pages();
    if (returned && !*returned) runs_.reset();  // more may be marked by then
    return returned;
}

Result<bool> Pruning::remove_piece(RunId run) {
    auto transaction = sqlite::Transaction::begin_write(*database_);
    if (!transaction) return transaction.error();
    auto removed = remove_items(run);
    if (removed && !*removed) removed = remove_blocks(run, first_segment_sql, remove_segments_sql);
    if (removed && !*removed) removed = remove_blocks(run, first_block_sql, remove_blocks_sql);
    if (removed && !*removed) removed = remove_raw(run);
    if (!removed) return removed;
    if (!*removed)
        for (const char* table : tables_of_run) {
            const std::array bound{std::int64_t{run.value}};
            if (auto done = remove_rows(*database_, std::string("DELETE FROM ") + table + " WHERE run = ?1", bound);
                !done)
                return done.error();
        }
    if (auto done = transaction->commit(); !done) return done.error();
    return removed;
}

Result<bool> Pruning::remove_items(RunId run) {
    static const std::string first_sql = first_key_sql();
    static const std::vector<std::string> remove_sql = remove_items_sql();
    auto first = database_->prepare(first_sql.c_str());
    if (!first) return first.error();
    first->bind(1, item_key(run, 0)).bind(2, item_key(run, sequence_max));
    const auto key = number_of(*first);
    if (!key) return key.error();
    if (!*key) return false;
    const std::array bound{**key, std::min(**key + items_a_step - 1, item_key(run, sequence_max))};
    for (const auto& sql : remove_sql)
        if (auto done = remove_rows(*database_, sql, bound); !done) return done.error();
    return true;
}

Result<bool> Pruning::remove_blocks(RunId run, const char* first_sql, std::span<const char* const> remove_sql) {
    auto first = database_->prepare(first_sql);
    if (!first) return first.error();
    first->bind(1, std::int64_t{run.value});
    const auto block = number_of(*first);
    if (!block) return block.error();
    if (!*block) return false;
    const std::array bound{std::int64_t{run.value}, **block, **block + segments_a_step};
    for (const char* sql : remove_sql)
        if (auto done = remove_rows(*database_, sql, bound); !done) return done.error();
    return true;
}

Result<bool> Pruning::remove_raw(RunId run) {
    const std::array bound{std::int64_t{run.value}, raw_pieces_a_step};
    if (auto done = remove_rows(*database_,
                                "DELETE FROM raw_octets WHERE (run, link, first) IN"
                                " (SELECT run, link, first FROM raw_octets WHERE run = ?1 LIMIT ?2)",
                                bound);
        !done)
        return done.error();
    const auto removed = database_->integer_of("SELECT changes()");
    if (!removed) return removed.error();
    return *removed > 0;
}

Result<bool> Pruning::return_pages() {
    const auto free = database_->integer_of("PRAGMA freelist_count");
    if (!free) return free.error();
    if (*free == 0) return false;
    const auto sql = "PRAGMA incremental_vacuum(" + std::to_string(pages_a_step) + ")";
    if (auto done = database_->execute(sql.c_str()); !done) return done.error();
    return true;
}

}  // namespace aeolis::archive
