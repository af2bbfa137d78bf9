// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/column_codec.hpp"
#include "server/archive/item_tables.hpp"
#include "server/archive/sqlite.hpp"

#include <string>

namespace aeolis::archive {

/// Writes a batch into the archive's tables, with statements prepared once. Its owner begins and commits the
/// transaction.
class RowWriter {
  public:
    static Result<RowWriter> open(sqlite::Database& database);

    Result<void> write(RunId run, const Batch& batch);

  private:
    /// The number that stands for a link's name in the table "words". A name that is not there yet is added.
    Result<std::int64_t> number_of_link(const std::string& name);
    template <typename Record>
    Result<void> item(RunId run, const Record& record, const Batch& batch);
    /// The number for a run's next segment or block: one above that which the statement `largest` selects.
    static Result<std::int64_t> next_number(RunId run, sqlite::Statement& largest);
    Result<void> segment(RunId run, const SegmentRecord& record, std::int64_t number);
    Result<void> column(std::int64_t key, const SegmentRecord& record, std::size_t column);
    Result<void> request(RunId run, const RequestRecord& record);
    Result<void> block(RunId run, const PyramidRecord& record, std::int64_t number);
    Result<void> totals(RunId run, const RecordingTotals& totals);
    Result<void> link_totals(RunId run, const LinkTotals& totals);
    Result<void> raw(RunId run, const RawRecord& record, std::uint64_t kept);
    Result<void> sequence_totals(RunId run, const std::string& link, const telemetry::SequenceTotals& totals);

    /// The INSERT statements for one kind of item and its parts.
    template <typename Record>
    struct ItemStatements {
        sqlite::Statement row, part;
    };
    OfItemKinds<ItemStatements> items_;
    sqlite::Statement search_, segment_number_, segment_, column_, block_number_, block_, block_column_, link_number_,
        link_word_, totals_, link_totals_, sequence_totals_, request_, raw_, raw_kind_, raw_removed_;
    ColumnCodec codec_;
};

}  // namespace aeolis::archive
