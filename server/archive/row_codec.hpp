// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/archive/sqlite.hpp"

#include <string>
#include <string_view>

// Rows of any table as octets, and back: each value as Statement::append_exact() writes it for fingerprints, so that
// what is read back is bound again as it was stored.
namespace aeolis::archive {

/// Appends all columns of the current row.
void append_row(const sqlite::Statement& row, std::string& octets);

/// Reads rows back, value by value.
class RowOctets {
  public:
    explicit RowOctets(std::string_view octets) : rest_(octets) {}

    bool empty() const { return rest_.empty(); }
    /// Binds the next value to a parameter. `integer`, unless null: the value if it is an integer, else -1. The Error:
    /// these are no octets of a row. Text and octets are not copied.
    Result<void> bind(sqlite::Statement& statement, int parameter, std::int64_t* integer = nullptr);

  private:
    std::string_view rest_;
};

}  // namespace aeolis::archive
