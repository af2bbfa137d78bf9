// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/spreadsheet/table.hpp"
#include "dictionaries/spreadsheet/tables.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <tuple>

namespace aeolis::dictionary {
namespace {

template <typename Rows>
std::optional<std::uint16_t> index_of(const Rows& rows, std::string_view name) {
    const auto row = std::ranges::find_if(rows, [&](const auto& one) { return one.name == name; });
    if (row == rows.end()) return std::nullopt;
    return static_cast<std::uint16_t>(row - rows.begin());
}

/// None, with a finding, when the cell names nothing; none when the file of the named row could not be read.
std::optional<Moment> read_moment(RowReader& cells, std::string_view column, Moment::Kind kind_of_plain_name,
                                  const ConstraintContext& context) {
    const std::string& cell = cells.text(column);
    if (cell == "do_edl") return Moment{};
    const auto colon = cell.find(':');
    const std::string name = cell.substr(0, colon);
    const std::string suffix = colon == std::string::npos ? "" : cell.substr(colon + 1);
    const auto fault = [&](const std::string& message) { cells.fault(std::string{column} + " " + message); };
    if (suffix == "anchor") {
        if (context.anchors == nullptr) return std::nullopt;
        if (const auto index = index_of(*context.anchors, name)) return Moment{Moment::Kind::anchor, *index};
        fault(in_quotes(cell) + ": there is no anchor " + in_quotes(name));
        return std::nullopt;
    }
    const bool known = colon == std::string::npos || suffix == "triggered" || suffix == "fired";
    if (!known) fault(in_quotes(cell) + ": " + in_quotes(suffix) + " is none of triggered, fired, anchor");
    if (!known || context.timeline == nullptr) return std::nullopt;
    const auto kind = suffix == "triggered" ? Moment::Kind::triggered
                      : suffix == "fired"   ? Moment::Kind::fired
                                            : kind_of_plain_name;
    if (const auto index = index_of(*context.timeline, name)) return Moment{kind, *index};
    const bool is_anchor = context.anchors != nullptr && index_of(*context.anchors, name);
    fault(in_quotes(cell) + ": there is no timepoint " + in_quotes(name) +
          (is_anchor ? "; the anchor is written " + in_quotes(name + ":anchor") : ""));
    return std::nullopt;
}

ConstraintRow::Kind read_kind(RowReader& cells) {
    const std::string& kind = cells.text("kind");
    if (kind == "given") return ConstraintRow::Kind::given;
    if (kind == "ensured") return ConstraintRow::Kind::ensured;
    if (kind != "required") cells.fault("kind " + in_quotes(kind) + " is none of required, given, ensured");
    return ConstraintRow::Kind::required;
}

void check_bounds(RowReader& cells, const ConstraintRow& row) {
    if (cells.text("minimum_s") == "undefined" && cells.text("maximum_s") == "undefined")
        cells.fault("neither minimum_s nor maximum_s bounds anything");
    if (row.minimum_s && row.maximum_s && *row.minimum_s > *row.maximum_s)
        cells.fault("minimum_s " + cells.text("minimum_s") + " is above maximum_s " + cells.text("maximum_s"));
}

/// A given row bounds when an anchor is set. Firings of timepoints follow from the timeline alone.
bool may_be_given(const Moment& to) {
    return to.kind == Moment::Kind::anchor;
}

}  // namespace

std::optional<std::vector<ConstraintRow>> read_constraints(std::string_view text, const ConstraintContext& context,
                                                           Findings& findings) {
    const auto table = Table::read(text, {"kind", "from", "to", "minimum_s", "maximum_s", "source", "note"}, findings);
    if (!table) return std::nullopt;
    if (table->rows().size() > constraints_max) {
        findings.add(table->rows()[constraints_max].line,
                     "more than " + std::to_string(constraints_max) + " constraints");
        return std::nullopt;
    }
    using Key = std::tuple<ConstraintRow::Kind, Moment::Kind, std::uint16_t, Moment::Kind, std::uint16_t>;
    std::map<Key, unsigned> lines;
    std::vector<ConstraintRow> rows;
    rows.reserve(table->rows().size());
    for (const Sheet::Row& sheet_row : table->rows()) {
        RowReader cells{*table, sheet_row, "constraint on", "to", findings};
        ConstraintRow row;
        row.line = sheet_row.line;
        row.kind = read_kind(cells);
        const auto from = read_moment(cells, "from", Moment::Kind::fired, context);
        const auto to = read_moment(cells, "to", Moment::Kind::triggered, context);
        row.minimum_s = cells.offset("minimum_s");
        row.maximum_s = cells.offset("maximum_s");
        check_bounds(cells, row);
        row.source = cells.required_text("source");
        row.note = cells.text("note");
        if (from && to) {
            row.from = *from;
            row.to = *to;
            if (*from == *to) cells.fault("from and to are the same moment");
            if (row.kind != ConstraintRow::Kind::required && !may_be_given(*to))
                cells.fault("only an anchor can be given; when a timepoint fires is for timeline.csv to say");
            const auto [first, added] =
                lines.emplace(Key{row.kind, from->kind, from->index, to->kind, to->index}, row.line);
            if (!added)
                cells.fault("from " + in_quotes(cells.text("from")) + " is there twice, first in line " +
                            std::to_string(first->second));
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

}  // namespace aeolis::dictionary
