// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

// Parsing of single words in spreadsheets and XML. Nothing is guessed: the whole word must be valid.
namespace aeolis::dictionary {

/// A word without the white space around it.
std::string_view trimmed(std::string_view word);

/// A finite decimal number: "-600.046875", "1e-3".
std::optional<double> to_number(std::string_view word);

/// A whole number, decimal or hexadecimal: "16", "-1", "0x010".
std::optional<std::int64_t> to_integer(std::string_view word);

/// Shortest text that parses to the same number.
std::string number_word(double value);

/// Why `name` cannot be a name in the C++ that the autocoder generates; none when it can.
std::optional<std::string> unusable_as_identifier(std::string_view name);

/// Whether the structs generated for packets, events or commands already have a member of that name.
bool is_taken_in_packets(std::string_view name);
bool is_taken_in_commands(std::string_view name);

}  // namespace aeolis::dictionary
