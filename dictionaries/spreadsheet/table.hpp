// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/spreadsheet/csv.hpp"

#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace aeolis::dictionary {

/// A sheet whose header names exactly the required columns, in any order.
class Table {
  public:
    /// None, with findings, when the text is not CSV, or a column is missing, unknown or repeated.
    static std::optional<Table> read(std::string_view text, std::initializer_list<std::string_view> columns,
                                     Findings& findings);

    const std::vector<Sheet::Row>& rows() const { return sheet_.rows; }
    std::size_t column(std::string_view name) const { return columns_.at(std::string{name}); }

  private:
    Sheet sheet_;
    std::map<std::string, std::size_t> columns_;
};

/// Reads the cells of one row; each wrong cell becomes a finding that names row and column.
class RowReader {
  public:
    /// `kind` and the cell in `name_column` identify the row in findings: timepoint 'coolant_vent'.
    RowReader(const Table& table, const Sheet::Row& row, std::string_view kind, std::string_view name_column,
              Findings& findings);

    const std::string& text(std::string_view column) const;
    std::string required_text(std::string_view column);
    /// A text that is usable as a name in C++.
    std::string identifier(std::string_view column);
    std::optional<double> number(std::string_view column);
    std::optional<std::int64_t> integer(std::string_view column, std::int64_t min, std::int64_t max);
    /// A multiple of 1/64 s, or "undefined". R13, R21
    MaybeOffset offset(std::string_view column);
    bool yes_or_no(std::string_view column);

    void fault(const std::string& message) { findings_.add(row_.line, subject_ + ": " + message); }
    unsigned line() const { return row_.line; }

  private:
    const Table& table_;
    const Sheet::Row& row_;
    Findings& findings_;
    std::string subject_;
};

}  // namespace aeolis::dictionary
