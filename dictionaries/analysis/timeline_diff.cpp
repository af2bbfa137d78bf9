// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/analysis/timeline_diff.hpp"

#include "dictionaries/analysis/timeline_analysis.hpp"
#include "dictionaries/words.hpp"

#include <algorithm>
#include <map>

namespace aeolis::dictionary {
namespace {

struct Cell {
    std::string column, text;
};
struct Row {
    std::string name;
    std::vector<Cell> cells;
};
using Rows = std::vector<Row>;

std::string offset_text(const MaybeOffset& offset_s) {
    return offset_s ? number_word(*offset_s) : "undefined";
}

Rows timeline_rows(const Dictionary& d) {
    Rows rows;
    rows.reserve(d.timeline.size());
    for (const TimelineRow& row : d.timeline)
        rows.push_back({row.name,
                        {{"reference", row.anchor ? d.anchors[row.anchor->value].name : "previous"},
                         {"desired_offset_s", offset_text(row.desired_offset_s)},
                         {"minimum_offset_s", offset_text(row.minimum_offset_s)},
                         {"action", row.action},
                         {"reply_timeout_s", offset_text(row.reply_timeout_s)},
                         {"if_unverified", row.reply_timeout_s ? name_of(row.if_unverified) : ""},
                         {"hold_repeat_s", row.hold_repeat_s ? number_word(*row.hold_repeat_s) : ""},
                         {"backtrack_point", row.backtrack},
                         {"essential", row.essential ? "yes" : "no"},
                         {"may_be_late", row.may_be_late ? "yes" : "no"},
                         {"tone", row.tone ? d.tones[row.tone->value].name : ""},
                         {"event", row.event},
                         {"note", row.note}}});
    return rows;
}

Rows anchor_rows(const Dictionary& d) {
    Rows rows;
    rows.reserve(d.anchors.size());
    for (const AnchorRow& row : d.anchors)
        rows.push_back({row.name,
                        {{"parent", row.parent ? d.anchors[row.parent->value].name : ""},
                         {"offset_s", offset_text(row.offset_s)},
                         {"note", row.note}}});
    return rows;
}

std::string kind_text(ConstraintRow::Kind kind) {
    switch (kind) {
    case ConstraintRow::Kind::required: return "required";
    case ConstraintRow::Kind::given: return "given";
    case ConstraintRow::Kind::ensured: return "ensured";
    }
    return {};
}

Rows constraint_rows(const Dictionary& d) {
    Rows rows;
    rows.reserve(d.constraints.size());
    for (const ConstraintRow& row : d.constraints)
        rows.push_back({kind_text(row.kind) + " " + moment_text(d, row.from) + " -> " + moment_text(d, row.to),
                        {{"minimum_s", offset_text(row.minimum_s)},
                         {"maximum_s", offset_text(row.maximum_s)},
                         {"source", row.source},
                         {"note", row.note}}});
    return rows;
}

/// Marks the places that form a longest increasing subsequence: rows that kept their order. All others moved.
std::vector<bool> in_order(const std::vector<std::size_t>& places) {
    std::vector<std::size_t> length(places.size(), 1);
    std::vector<std::size_t> comes_after(places.size(), places.size());
    for (std::size_t i = 0; i < places.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (places[j] < places[i] && length[j] + 1 > length[i]) {
                length[i] = length[j] + 1;
                comes_after[i] = j;
            }
    std::vector<bool> kept(places.size(), false);
    const auto longest = std::ranges::max_element(length);
    for (auto at = static_cast<std::size_t>(longest - length.begin()); at < places.size(); at = comes_after[at])
        kept[at] = true;
    return kept;
}

std::vector<CellChange> changed_cells(const Row& before, const Row& after) {
    std::vector<CellChange> changes;
    for (std::size_t i = 0; i < after.cells.size(); ++i)
        if (before.cells[i].text != after.cells[i].text)
            changes.push_back({after.cells[i].column, before.cells[i].text, after.cells[i].text});
    return changes;
}

std::map<std::string, std::size_t> places_of(const Rows& rows) {
    std::map<std::string, std::size_t> places;
    for (std::size_t i = 0; i < rows.size(); ++i) places.emplace(rows[i].name, i);
    return places;
}

SheetDiff compare(std::string file, const Rows& before, const Rows& after) {
    SheetDiff diff{std::move(file), {}};
    const auto before_places = places_of(before);
    const auto after_places = places_of(after);
    for (std::size_t i = 0; i < before.size(); ++i)
        if (!after_places.contains(before[i].name))
            diff.rows.push_back({before[i].name, i + 1, std::nullopt, false, {}});

    std::vector<std::size_t> common;
    common.reserve(after.size());
    for (const Row& row : after)
        if (const auto found = before_places.find(row.name); found != before_places.end())
            common.push_back(found->second);
    const auto kept = in_order(common);
    std::size_t of_common = 0;
    for (std::size_t i = 0; i < after.size(); ++i) {
        const auto found = before_places.find(after[i].name);
        if (found == before_places.end()) {
            diff.rows.push_back({after[i].name, std::nullopt, i + 1, false, {}});
            continue;
        }
        const bool moved = !kept[of_common++];
        auto cells = changed_cells(before[found->second], after[i]);
        if (moved || !cells.empty())
            diff.rows.push_back({after[i].name, found->second + 1, i + 1, moved, std::move(cells)});
    }
    return diff;
}

}  // namespace

bool TimelineDiff::same() const {
    return std::ranges::all_of(sheets, [](const SheetDiff& sheet) { return sheet.rows.empty(); });
}

TimelineDiff compare_timelines(const Dictionary& before, const Dictionary& after) {
    return {before.timeline_version,
            after.timeline_version,
            {compare("timeline.csv", timeline_rows(before), timeline_rows(after)),
             compare("anchors.csv", anchor_rows(before), anchor_rows(after)),
             compare("constraints.csv", constraint_rows(before), constraint_rows(after))}};
}

}  // namespace aeolis::dictionary
