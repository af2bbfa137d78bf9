// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <optional>
#include <string>
#include <vector>

// Differences between two versions of the timeline, by row and cell. R20
namespace aeolis::dictionary {

struct CellChange {
    std::string column;
    std::string before, after;  ///< as in the sheet; numbers in their shortest form
};

/// A row that differs between the two versions, or is in only one of them.
struct RowChange {
    std::string name;                          ///< identifies the row: timepoint, anchor, or "required a -> b"
    std::optional<std::size_t> before, after;  ///< place in the sheet, from 1; none: the row is not in that version
    bool moved = false;                        ///< its order among the rows common to both has changed
    std::vector<CellChange> cells;
};

struct SheetDiff {
    std::string file;
    std::vector<RowChange> rows;  ///< removed rows first, then in the later version's order
};

struct TimelineDiff {
    std::uint32_t version_before = 0, version_after = 0;
    std::vector<SheetDiff> sheets;  ///< timeline.csv, anchors.csv, constraints.csv

    bool same() const;
};

/// Compares the meaning of the rows, not their spelling.
/// Two versions that differ only in spelling (7 and 7.0) have different version numbers, but no
/// difference here.
TimelineDiff compare_timelines(const Dictionary& before, const Dictionary& after);

}  // namespace aeolis::dictionary
