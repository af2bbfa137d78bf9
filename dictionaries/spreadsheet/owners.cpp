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
    if (kind == "device") return OwnedKind::device;
    if (kind == "decision") return OwnedKind::decision;
    cells.fault("kind " + in_quotes(kind) + " is none of device, decision");
    return std::nullopt;
}

const Type* decisions_of(const std::vector<const Type*>* enumerations) {
    if (enumerations == nullptr) return nullptr;
    const auto found = std::ranges::find(*enumerations, "Decision", [](const Type* type) { return type->name; });
    return found == enumerations->end() ? nullptr : *found;
}

/// Checks that a decision is one of the enumeration.
void check_owned(RowReader& cells, OwnedKind kind, const std::string& name, const Type* decisions) {
    if (kind == OwnedKind::decision && decisions != nullptr &&
        std::ranges::find(decisions->enumeration, name, &EnumValue::label) == decisions->enumeration.end())
        cells.fault("is no label of the enumeration 'Decision'");
}

/// Adds a finding at the sheet's end for each decision without an owner.
void check_missing(const Type* decisions, const Lines& lines, unsigned last_line, Findings& findings) {
    if (decisions == nullptr) return;
    for (const EnumValue& decision : decisions->enumeration)
        if (!lines.contains({OwnedKind::decision, decision.label}))
            findings.add(last_line, "decision " + in_quotes(decision.label) + " has no owner");
}

}  // namespace

std::optional<std::vector<OwnerRow>> read_owners(std::string_view text, const std::vector<const Type*>* enumerations,
                                                 Findings& findings) {
    const auto table = Table::read(text, {"kind", "name", "module", "note"}, findings);
    if (!table) return std::nullopt;
    if (table->rows().size() > owners_max) {
        findings.add(table->rows()[owners_max].line, "more than " + std::to_string(owners_max) + " owners");
        return std::nullopt;
    }
    const Type* decisions = decisions_of(enumerations);
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
            if (!row.name.empty()) check_owned(cells, *kind, row.name, decisions);
            const auto [first, added] = lines.emplace(std::pair{*kind, row.name}, row.line);
            if (!added) cells.fault("has an owner already, in line " + std::to_string(first->second));
        }
        sound = sound && findings.size() == before;
        rows.push_back(std::move(row));
    }
    if (sound) check_missing(decisions, lines, rows.empty() ? 1 : rows.back().line, findings);
    return rows;
}

}  // namespace aeolis::dictionary
