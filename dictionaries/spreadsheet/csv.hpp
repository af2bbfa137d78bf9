// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/findings.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::dictionary {

/// A spreadsheet as saved: a header, and rows with as many cells. Lines count from 1.
struct Sheet {
    struct Row {
        unsigned line = 0;
        std::vector<std::string> cells;
    };
    Row header;
    std::vector<Row> rows;  ///< rows whose cells are all empty are left out
};

/// Parses RFC 4180 text: commas, quotes doubled within quotes, line breaks within quotes.
/// A byte order mark and CRLF, which spreadsheet programs write, are accepted; nothing else is corrected. A finding
/// names line and column; then no sheet is returned.
std::optional<Sheet> read_csv(std::string_view text, Findings& findings);

}  // namespace aeolis::dictionary
