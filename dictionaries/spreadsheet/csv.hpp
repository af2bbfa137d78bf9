// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/findings.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::dictionary {

/// A spreadsheet as it was saved: a header and rows of as many cells. Lines count from 1.
struct Sheet {
    struct Row {
        unsigned line = 0;
        std::vector<std::string> cells;
    };
    Row header;
    std::vector<Row> rows;  ///< rows whose cells are all empty are left out
};

/// RFC 4180: commas, quotes doubled within quotes, line breaks within quotes. A byte order mark and CRLF, which
/// spreadsheet programs write, are accepted; nothing else is mended. Faults name line and column; then there is no
/// sheet.
std::optional<Sheet> read_csv(std::string_view text, Findings& findings);

}  // namespace aeolis::dictionary
