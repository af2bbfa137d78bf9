// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/spreadsheet/table.hpp"
#include "dictionaries/spreadsheet/tables.hpp"

#include "dictionaries/words.hpp"

#include <map>
#include <string>

namespace aeolis::dictionary {
namespace {

ParameterRow::Change read_change(RowReader& cells) {
    const std::string& cell = cells.text("change");
    if (cell == "build") return ParameterRow::Change::build;
    if (cell != "until_gnc") cells.fault("change " + in_quotes(cell) + " is none of until_gnc, build");
    return ParameterRow::Change::until_gnc;
}

}  // namespace

std::optional<std::vector<ParameterRow>> read_parameters(std::string_view text, Findings& findings) {
    const auto table =
        Table::read(text, {"name", "default", "min", "max", "change", "unit", "text", "source"}, findings);
    if (!table) return std::nullopt;
    if (table->rows().size() > parameters_max) {
        findings.add(table->rows()[parameters_max].line, "more than " + std::to_string(parameters_max) + " parameters");
        return std::nullopt;
    }
    std::vector<ParameterRow> rows;
    std::map<std::string, unsigned> lines;
    for (const Sheet::Row& row : table->rows()) {
        RowReader cells{*table, row, "parameter", "name", findings};
        const std::string name = cells.identifier("name");
        const auto [first, added] = lines.emplace(name, row.line);
        if (!added) cells.fault("is there twice, first in line " + std::to_string(first->second));
        const auto value = cells.number("default");
        const auto min = cells.number("min");
        const auto max = cells.number("max");
        if (min && max && *min > *max)
            cells.fault("min " + number_word(*min) + " is above max " + number_word(*max));
        else if (value && min && max && (*value < *min || *value > *max))
            cells.fault("default " + number_word(*value) + " is outside " + number_word(*min) + " ... " +
                        number_word(*max));
        if (cells.text("unit").empty()) cells.fault("has no unit (1 for a pure number)");
        const ParameterId id{static_cast<std::uint16_t>(rows.size())};
        rows.push_back({id, name, value.value_or(0.0), min.value_or(0.0), max.value_or(0.0), read_change(cells),
                        cells.text("unit"), cells.required_text("text"), cells.required_text("source")});
    }
    return rows;
}

}  // namespace aeolis::dictionary
