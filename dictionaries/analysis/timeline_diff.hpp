// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <optional>
#include <string>
#include <vector>

// What changed from one version of the timeline to another, row by row and cell by cell. R20
namespace aeolis::dictionary {

struct CellChange {
    std::string column;
    std::string before, after;  ///< as in the sheet; numbers in their shortest form
};

/// A row of either version that is not the same in both.
struct RowChange {
    std::string name;                          ///< what identifies the row: timepoint, anchor, or "required a -> b"
    std::optional<std::size_t> before, after;  ///< place in the sheet, from 1; none: it was added, or removed
    bool moved = false;                        ///< stands elsewhere among the rows that both have
    std::vector<CellChange> cells;
};

struct SheetDiff {
    std::string file;
    std::vector<RowChange> rows;  ///< removed ones first, then as in the later version
};

struct TimelineDiff {
    std::uint16_t version_before = 0, version_after = 0;
    std::vector<SheetDiff> sheets;  ///< timeline.csv, anchors.csv, constraints.csv

    bool same() const;
};

/// Compares what the rows say. Two versions that differ in spelling only (7 and 7.0, line ends, quotes) have different
/// numbers and no difference here.
TimelineDiff compare_timelines(const Dictionary& before, const Dictionary& after);

}  // namespace aeolis::dictionary
