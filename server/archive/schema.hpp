// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "server/archive/records.hpp"
#include "server/archive/sqlite.hpp"

#include <vector>

namespace aeolis::archive {

/// Creates the schema (tables, indices, views) in an empty database, or checks that it exists. Fails with "FILE is not
/// an Aeolis archive" or "FILE has archive schema N, this program has M: …".
Result<void> prepare_for_writing(sqlite::Database& database);
Result<void> check_for_reading(sqlite::Database& database);

/// Adds the names of a dictionary, with which other programs read its runs, unless they are there.
Result<void> add_dictionary(sqlite::Database& database, const dictionary::Dictionary& dictionary);

/// Key of an item's row: run and sequence number in one integer. The rows of a run are then adjacent and in order, and
/// every insert is an append.
constexpr std::int64_t item_key(RunId run, Sequence seq) {
    return static_cast<std::int64_t>((static_cast<std::uint64_t>(run.value) << 40) | seq);
}
inline constexpr Sequence sequence_max = (Sequence{1} << 40) - 1;
constexpr Sequence sequence_of(std::int64_t key) {
    return static_cast<Sequence>(key) & sequence_max;
}

/// Number of a segment or pyramid block: the run and a number within it, so that a rebuilt one keeps its number.
inline constexpr std::int64_t segments_max = std::int64_t{1} << 23;
constexpr std::int64_t segment_key(RunId run, std::int64_t number) {
    return std::int64_t{run.value} * segments_max + number;
}

/// Key of a column of a segment or block.
constexpr std::int64_t column_key(std::int64_t segment, ChannelId channel) {
    return segment * 65'536 + channel.value;
}

/// A table with rows of runs, and an SQL condition that selects those of run ?1.
struct RunTable {
    const char* name;
    const char* rows;
    bool derived;  ///< all rows follow from packets; else some were received or decided once
};
/// All tables but those of dictionaries and words, in an order in which they can be emptied.
const std::vector<RunTable>& run_tables();

/// SQL that adds the words of items to the search index (table "search"); ?1, ?2: their first and last key. They must
/// not be in it already.
inline constexpr char add_to_search_sql[] =
    "INSERT INTO search (rowid, text) SELECT key, text FROM search_text WHERE key BETWEEN ?1 AND ?2";

/// SQL for the last sequence number of each table; ?1 = item_key(run, 0), ?2 = item_key(run, max).
const char* last_key_sql();

}  // namespace aeolis::archive
