// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/spreadsheet/table.hpp"

#include "dictionaries/words.hpp"

#include <algorithm>

namespace aeolis::dictionary {

std::optional<Table> Table::read(std::string_view text, std::initializer_list<std::string_view> columns,
                                 Findings& findings) {
    auto sheet = read_csv(text, findings);
    if (!sheet) return std::nullopt;
    Table table;
    table.sheet_ = std::move(*sheet);
    bool sound = true;
    const auto fault = [&](const std::string& message) {
        findings.add(table.sheet_.header.line, message);
        sound = false;
    };
    const auto& header = table.sheet_.header.cells;
    for (std::size_t i = 0; i < header.size(); ++i) {
        if (std::ranges::find(columns, header[i]) == columns.end())
            fault("unknown column " + in_quotes(header[i]));
        else if (!table.columns_.emplace(header[i], i).second)
            fault("column " + in_quotes(header[i]) + " is there twice");
    }
    for (const std::string_view column : columns)
        if (!table.columns_.contains(std::string{column})) fault("column " + in_quotes(column) + " is missing");
    if (!sound) return std::nullopt;
    return table;
}

RowReader::RowReader(const Table& table, const Sheet::Row& row, std::string_view kind, std::string_view name_column,
                     Findings& findings)
    : table_(table), row_(row), findings_(findings),
      subject_(std::string{kind} + " " + in_quotes(row.cells[table.column(name_column)])) {}

const std::string& RowReader::text(std::string_view column) const {
    return row_.cells[table_.column(column)];
}

std::string RowReader::required_text(std::string_view column) {
    if (text(column).empty()) fault(std::string{column} + " is empty");
    return text(column);
}

std::string RowReader::identifier(std::string_view column) {
    if (const auto why = unusable_as_identifier(text(column))) fault(std::string{column} + " " + *why);
    return text(column);
}

std::optional<double> RowReader::number(std::string_view column) {
    const auto value = to_number(text(column));
    if (!value) fault(std::string{column} + " " + in_quotes(text(column)) + " is not a number");
    return value;
}

std::optional<std::int64_t> RowReader::integer(std::string_view column, std::int64_t min, std::int64_t max) {
    const auto value = to_integer(text(column));
    if (value && *value >= min && *value <= max) return value;
    fault(std::string{column} + " " + in_quotes(text(column)) + " is not a whole number from " + std::to_string(min) +
          " to " + std::to_string(max));
    return std::nullopt;
}

MaybeOffset RowReader::offset(std::string_view column) {
    const std::string& cell = text(column);
    if (cell == "undefined") return std::nullopt;
    const auto value = to_number(cell);
    if (!value) {
        fault(std::string{column} + " " + in_quotes(cell) + " is neither a number nor undefined");
        return std::nullopt;
    }
    if (!is_multiple_of_tick(*value)) {
        fault(std::string{column} + " " + cell + " is not a multiple of 1/64 s");
        return std::nullopt;
    }
    return value;
}

bool RowReader::yes_or_no(std::string_view column) {
    const std::string& cell = text(column);
    if (cell != "yes" && cell != "no") fault(std::string{column} + " " + in_quotes(cell) + " is neither yes nor no");
    return cell == "yes";
}

}  // namespace aeolis::dictionary
