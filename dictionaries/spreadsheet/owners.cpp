// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/spreadsheet/owners.hpp"

#include "dictionaries/spreadsheet/table.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

namespace aeolis::dictionary {
namespace {

using OwnedKind = OwnerRow::Kind;
using Lines = std::map<std::pair<OwnedKind, std::string>, unsigned>;

std::optional<OwnedKind> read_owned_kind(RowReader& cells) {
    const std::string& kind = cells.text("kind");
    if (kind == "action") return OwnedKind::action;
    if (kind == "device") return OwnedKind::device;
    if (kind == "decision") return OwnedKind::decision;
    cells.fault("kind " + in_quotes(kind) + " is none of action, device, decision");
    return std::nullopt;
}

const Type* decisions_of(const OwnerContext& context) {
    if (context.enumerations == nullptr) return nullptr;
    const auto found =
        std::ranges::find(*context.enumerations, "Decision", [](const Type* type) { return type->name; });
    return found == context.enumerations->end() ? nullptr : *found;
}

/// Checks that the row's subject exists: an action in the timeline, a decision in the enumeration.
void check_owned(RowReader& cells, OwnedKind kind, const std::string& name, const OwnerContext& context) {
    const Type* decisions = decisions_of(context);
    if (kind == OwnedKind::action && context.timeline != nullptr &&
        std::ranges::find(*context.timeline, name, &TimelineRow::action) == context.timeline->end())
        cells.fault("no timepoint has an action of that name");
    if (kind == OwnedKind::decision && decisions != nullptr &&
        std::ranges::find(decisions->enumeration, name, &EnumValue::label) == decisions->enumeration.end())
        cells.fault("is no label of the enumeration 'Decision'");
}

/// Adds a finding at the sheet's end for each subject without an owner.
void check_missing(const OwnerContext& context, const Lines& lines, unsigned last_line, Findings& findings) {
    std::vector<std::string> missing;
    const auto need = [&](OwnedKind kind, const char* word, const std::string& name) {
        const std::string text = std::string{word} + " " + in_quotes(name) + " has no owner";
        if (!name.empty() && !lines.contains({kind, name}) && std::ranges::find(missing, text) == missing.end())
            missing.push_back(text);
    };
    if (context.timeline != nullptr)
        for (const TimelineRow& row : *context.timeline) need(OwnedKind::action, "action", row.action);
    if (const Type* decisions = decisions_of(context))
        for (const EnumValue& label : decisions->enumeration) need(OwnedKind::decision, "decision", label.label);
    for (const std::string& text : missing) findings.add(last_line, text);
}

}  // namespace

std::optional<std::vector<OwnerRow>> read_owners(std::string_view text, const OwnerContext& context,
                                                 Findings& findings) {
    const auto table = Table::read(text, {"kind", "name", "module", "note"}, findings);
    if (!table) return std::nullopt;
    if (table->rows().size() > owners_max) {
        findings.add(table->rows()[owners_max].line, "more than " + std::to_string(owners_max) + " owners");
        return std::nullopt;
    }
    Lines lines;
    std::vector<OwnerRow> rows;
    bool sound = true;  // false: a row is broken, so its subject must not be reported as missing too
    for (const Sheet::Row& sheet_row : table->rows()) {
        const std::size_t before = findings.size();
        RowReader cells{*table, sheet_row, sheet_row.cells[table->column("kind")], "name", findings};
        OwnerRow row;
        row.line = sheet_row.line;
        row.name = cells.identifier("name");
        row.module = cells.identifier("module");
        row.note = cells.text("note");
        if (const auto kind = read_owned_kind(cells)) {
            row.kind = *kind;
            if (!row.name.empty()) check_owned(cells, *kind, row.name, context);
            const auto [first, added] = lines.emplace(std::pair{*kind, row.name}, row.line);
            if (!added) cells.fault("has an owner already, in line " + std::to_string(first->second));
        }
        sound = sound && findings.size() == before;
        rows.push_back(std::move(row));
    }
    if (sound) check_missing(context, lines, rows.empty() ? 1 : rows.back().line, findings);
    return rows;
}

}  // namespace aeolis::dictionary
