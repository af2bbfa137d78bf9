// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <string>
#include <string_view>

namespace aeolis::server {

/// Whether a spreadsheet would compute the text instead of showing it.
inline bool is_formula(const std::string& text) {
    if (text.empty() || std::string_view{"=+-@\t\r"}.find(text.front()) == std::string_view::npos) return false;
    double number = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error != std::errc{} || end != text.data() + text.size();
}

/// A CSV field (RFC 4180). Text by people or other missions may begin like a formula: an apostrophe in front makes a
/// spreadsheet show it as text.
inline std::string csv_text(const std::string& text) {
    const std::string shown = is_formula(text) ? "'" + text : text;
    if (shown.find_first_of(",\"\r\n") == std::string::npos) return shown;
    std::string quoted = "\"";
    for (const char c : shown) quoted.append(c == '"' ? 2 : 1, c);
    return quoted + '"';
}

}  // namespace aeolis::server
